#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "harness/geometry/box.h"
#include "harness/method/cost_model.h"

// Without AVX-512 the compiler warns that vectors of 64 bytes are passed to functions in another way than with it. All of these are
// inline, in files that are compiled alike.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace raystudy::insertion {

using Float16 = float __attribute__((vector_size(64)));

/// The first `count` floats at `from`, then zeros. The compiler would go through memory for what a mask does in one instruction.
template <std::size_t count>
inline Float16 load_lanes(const float* from) {
  static_assert(count <= 16);
#ifdef __AVX512F__
  return static_cast<Float16>(_mm512_maskz_loadu_ps(static_cast<__mmask16>((1U << count) - 1U), from));
#else
  Float16 v{};
  std::memcpy(&v, from, count * sizeof(float));
  return v;
#endif
}

/// Writes lanes side, side + 2, … below `count`; the others stay as they are.
template <std::size_t count>
inline void store_lanes_of(std::uint32_t side, Float16 v, float* to) {
#ifdef __AVX512F__
  _mm512_mask_storeu_ps(to, static_cast<__mmask16>((0x5555U << side) & ((1U << count) - 1U)), static_cast<__m512>(v));
#else
  for (std::size_t lane = side; lane < count; lane += 2) to[lane] = v[lane];
#endif
}

inline Float16 max(Float16 a, Float16 b) { return a < b ? b : a; }

/// Two siblings' boxes in each of several frames: `blocks` times `per_block` of them, as many as are used and no more, since a
/// search is bound by the bytes of its records (256 of them for five frames). In a block stand, for each axis, the negated lower
/// and the upper bounds, so that a union is `max`; among those the frames, and of each frame the first and the second sibling, so
/// that the sum over the frames leaves the two siblings' sums side by side.
template <std::size_t per_block, std::size_t blocks>
struct FrameBoxes {
  static constexpr std::size_t frames = per_block * blocks;
  static constexpr std::size_t lanes = 2 * per_block;
  static constexpr std::size_t vectors = 6 * blocks;

  /// The boxes of one sibling, twice; or those of both, in registers.
  struct Doubled {
    std::array<Float16, vectors> v{};

    /// The first sibling's box in frame `f`.
    [[nodiscard]] Box box(std::size_t f, std::size_t side = 0) const {
      const std::size_t lane = 2 * (f % per_block) + side;
      const Float16* at = &v[6 * (f / per_block)];
      return {{-at[0][lane], -at[2][lane], -at[4][lane]}, {at[1][lane], at[3][lane], at[5][lane]}};
    }
    /// Sets the box of both in frame `f`.
    void set(std::size_t f, const Box& box) {
      const std::size_t lane = 2 * (f % per_block);
      Float16* at = &v[6 * (f / per_block)];
      for (int axis = 0; axis < 3; ++axis) {
        at[2 * axis][lane] = at[2 * axis][lane + 1] = -box.lower[axis];
        at[2 * axis + 1][lane] = at[2 * axis + 1][lane + 1] = box.upper[axis];
      }
    }
  };

  std::array<float, lanes * vectors> values{};

  [[nodiscard]] Float16 load(std::size_t i) const { return load_lanes<lanes>(&values[lanes * i]); }

  [[nodiscard]] Doubled both() const {
    Doubled d;
    for (std::size_t i = 0; i < vectors; ++i) d.v[i] = load(i);
    return d;
  }
  /// The boxes of one side, twice.
  [[nodiscard]] Doubled doubled(std::uint32_t side) const {
    Doubled d;
    for (std::size_t i = 0; i < vectors; ++i) {
      const Float16 v = load(i);
      d.v[i] = side == 0 ? __builtin_shufflevector(v, v, 0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10, 12, 12, 14, 14)
                         : __builtin_shufflevector(v, v, 1, 1, 3, 3, 5, 5, 7, 7, 9, 9, 11, 11, 13, 13, 15, 15);
    }
    return d;
  }
  void set(std::uint32_t side, const Doubled& d) {
    for (std::size_t i = 0; i < vectors; ++i) store_lanes_of<lanes>(side, d.v[i], &values[lanes * i]);
  }
  /// The unions of the two siblings, twice.
  [[nodiscard]] Doubled merged() const {
    Doubled d;
    for (std::size_t i = 0; i < vectors; ++i) {
      const Float16 v = load(i);
      d.v[i] = max(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
    }
    return d;
  }
  /// In the first frame.
  [[nodiscard]] Box box(std::uint32_t side) const { return both().box(0, side); }

  friend Doubled united(const FrameBoxes& a, const Doubled& b) {
    Doubled d;
    for (std::size_t i = 0; i < vectors; ++i) d.v[i] = max(a.load(i), b.v[i]);
    return d;
  }
  friend Doubled united(const Doubled& a, const Doubled& b) {
    Doubled d;
    for (std::size_t i = 0; i < vectors; ++i) d.v[i] = max(a.v[i], b.v[i]);
    return d;
  }
  friend bool same(const Doubled& a, const Doubled& b) {
    auto differ = a.v[0] != b.v[0];
    for (std::size_t i = 1; i < vectors; ++i) differ |= a.v[i] != b.v[i];
    for (std::size_t lane = 0; lane < lanes; lane += 2) {
      if (differ[lane] != 0) return false;
    }
    return true;
  }
};

/// Half areas of both siblings in the frames of one block, lanes as FrameBoxes has them; each rounded as Box::half_area.
inline Float16 half_areas(const Float16* v) {
  const Float16 x = v[0] + v[1];
  const Float16 y = v[2] + v[3];
  const Float16 z = v[4] + v[5];
  return x * y + y * z + z * x;
}

/// Σ_i ω_i m(N(t_i)) with m half the surface area: what T-SAH measures a node by (Bittner and Meister 2015, Eq. 2).
template <class Boxes>
struct FrameAreas {
  using Doubled = typename Boxes::Doubled;
  static constexpr std::size_t blocks = Boxes::vectors / 6;

  std::array<Float16, blocks> weights{};  ///< each frame's twice; 0 for frames that are not used

  void set(std::span<const float> by_frame) {
    constexpr std::size_t per_block = Boxes::frames / blocks;
    weights = {};
    for (std::size_t f = 0; f < by_frame.size(); ++f) {
      const std::size_t lane = 2 * (f % per_block);
      weights[f / per_block][lane] = weights[f / per_block][lane + 1] = by_frame[f];
    }
  }
};

/// The two siblings' measures. Summed in a fixed order.
template <class Boxes>
inline std::array<float, 2> measure_both(const FrameAreas<Boxes>& measure, const typename Boxes::Doubled& b) {
  Float16 sum = half_areas(&b.v[0]) * measure.weights[0];
  for (std::size_t i = 1; i < measure.weights.size(); ++i) sum += half_areas(&b.v[6 * i]) * measure.weights[i];
  using Float8 = float __attribute__((vector_size(32)));
  using Float4 = float __attribute__((vector_size(16)));
  const Float8 eight =
      __builtin_shufflevector(sum, sum, 0, 1, 2, 3, 4, 5, 6, 7) + __builtin_shufflevector(sum, sum, 8, 9, 10, 11, 12, 13, 14, 15);
  const Float4 four = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) + __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
  return {four[0] + four[2], four[1] + four[3]};
}

/// The same with any measure in place of the surface area.
template <class Boxes>
struct FrameMeasures {
  const Measure* measure = nullptr;
  std::span<const float> weights;
};

template <class Boxes>
inline std::array<float, 2> measure_both(const FrameMeasures<Boxes>& measure, const typename Boxes::Doubled& b) {
  std::array<Box, 2 * Boxes::frames> boxes;
  std::array<float, 2 * Boxes::frames> m{};
  const std::size_t used = measure.weights.size();
  for (std::size_t f = 0; f < used; ++f) {
    boxes[2 * f] = b.box(f, 0);
    boxes[2 * f + 1] = b.box(f, 1);
  }
  measure.measure->evaluate(std::span(boxes).first(2 * used), std::span(m).first(2 * used));
  std::array<float, 2> sums{};
  for (std::size_t f = 0; f < used; ++f) {
    for (std::size_t side = 0; side < 2; ++side) sums[side] += m[2 * f + side] * measure.weights[f];
  }
  return sums;
}

template <class Boxes>
inline std::array<float, 2> measure_both(const FrameAreas<Boxes>& measure, const Boxes& boxes) {
  return measure_both(measure, boxes.both());
}
template <class Boxes>
inline std::array<float, 2> measure_both(const FrameMeasures<Boxes>& measure, const Boxes& boxes) {
  return measure_both(measure, boxes.both());
}

}  // namespace raystudy::insertion
