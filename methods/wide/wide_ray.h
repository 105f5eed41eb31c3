#pragma once

#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/geometry/box.h"
#include "harness/geometry/ray.h"

namespace raystudy::wide {

/// What all rays of a session have in common.
struct SlabScene {
  /// Past this, what replaces a tiny component of a direction would move the ray (WideRay): no box is culled.
  static constexpr float largest = 0x1p80F;

  alignas(16) std::array<float, 4> lower{};  ///< a box that holds every box and triangle that will be tested
  alignas(16) std::array<float, 4> upper{};
  float reach = 0;  ///< its largest coordinate, by magnitude

  explicit SlabScene(const Box& b) : lower{b.lower.x, b.lower.y, b.lower.z, 0}, upper{b.upper.x, b.upper.y, b.upper.z, 0} {
    for (int i = 0; i < 3; ++i) reach = max(reach, max(std::fabs(b.lower[i]), std::fabs(b.upper[i])));
  }
};

/// A ray made ready for tests of triangles: its axes, and what shears them. See ShearedRay in harness/geometry/watertight.h.
struct TriangleRay {
  int across, up, along;
  std::array<float, 3> origin;  ///< along `across`, `up` and `along`
  float shear_across, shear_up;
  float direction_along;
};

/// A ray made ready for tests of many boxes by one fused multiply-add a plane: t = plane · reciprocal - offset. No box is missed
/// that holds a triangle which the watertight test (harness/geometry/watertight.h) accepts.
///
/// All that rounds is moved to the safe side once per ray, as a displacement of the origin along each axis (compare SlabRay in
/// harness/geometry/slab.h, where Woop's and Ize's bounds come from). With u = 2⁻²⁴, |plane - origin| ≤ reach_i, |plane| and
/// |origin| ≤ reach_i + |origin|:
///   6 u (reach_i + farthest)     the displacement of sheared corners (Woop, Benthin, Wald 2013, Sec. 4) and t's own rounding
///   2 u reach_i                  the reciprocal's rounding and the last rounding of t
///   6 u (|origin| + reach_i)     the offset's two roundings and, without fused instructions, that of the product
/// A component of the direction that is 0 or tiny is replaced by one so small that it moves the ray, within the scene, by less
/// than the displacement; so every reciprocal is finite and no product is NaN.
struct WideRay : TriangleRay {
  // One value an axis; the fourth is not used.
  alignas(16) std::array<float, 4> reciprocal;
  alignas(16) std::array<float, 4> near_offset;
  alignas(16) std::array<float, 4> far_offset;
  unsigned negative;  ///< bit i: along axis i upper planes are entered first
  float scale = 1;    ///< t of the boxes over t of the ray; a power of two
  bool valid;         ///< finite, a direction that is not zero, 0 <= tmin <= tmax; a ray that is not valid hits nothing

  WideRay(const Ray& ray, const SlabScene& scene) {
    const __m128 sign = _mm_set1_ps(-0.0F);
    const __m128 o = _mm_loadu_ps(&ray.origin.x);  // and tmin
    __m128 d = _mm_loadu_ps(&ray.direction.x);     // and tmax
    const __m128 o_size = _mm_andnot_ps(sign, o);
    const __m128 d_size = _mm_andnot_ps(sign, d);
    // x > y, y > z, x > z: together they say which is the largest, with ties as ShearedRay has them.
    const int order = _mm_movemask_ps(_mm_cmpgt_ps(_mm_shuffle_ps(d_size, d_size, _MM_SHUFFLE(3, 0, 1, 0)),
                                                   _mm_shuffle_ps(d_size, d_size, _MM_SHUFFLE(3, 2, 2, 1))));
    static constexpr std::array<std::uint8_t, 8> largest{2, 2, 1, 2, 2, 0, 1, 0};
    along = largest[static_cast<std::size_t>(order & 7)];
    static constexpr std::array<std::uint8_t, 5> cycle{0, 1, 2, 0, 1};
    across = cycle[static_cast<std::size_t>(along) + 1];
    up = cycle[static_cast<std::size_t>(along) + 2];
    const float* const direction = &ray.direction.x;
    const float* const from = &ray.origin.x;
    direction_along = direction[along];
    shear_across = direction[across] / direction_along;
    shear_up = direction[up] / direction_along;
    origin = {from[across], from[up], from[along]};
    const __m128 infinity = _mm_set1_ps(std::numeric_limits<float>::infinity());
    const int finite = _mm_movemask_ps(_mm_and_ps(_mm_cmplt_ps(o_size, infinity), _mm_cmplt_ps(d_size, infinity)));
    const float longest = std::fabs(direction_along);
    valid = (finite & 7) == 7 && longest > 0 && ray.tmin >= 0 && ray.tmin <= ray.tmax;
    if (!valid) return;
    if (!(longest > 0x1p-20F && longest < 0x1p20F)) [[unlikely]] {
      d = rescaled(ray.direction, longest);
    }
    set_slabs(o, d, scene);
  }

  /// t of the ray → t of the boxes.
  [[nodiscard]] float scaled(float t) const { return t * scale; }

 private:
  __m128 rescaled(Vec3 d, float longest) {
    const int exponent = std::ilogb(longest);
    scale = std::ldexp(1.0F, exponent);
    return _mm_setr_ps(std::ldexp(d.x, -exponent), std::ldexp(d.y, -exponent), std::ldexp(d.z, -exponent), 0);
  }

  /// The largest of the first three lanes, in all lanes.
  static __m128 largest_of(__m128 v) {
    const __m128 yzx = _mm_shuffle_ps(v, v, _MM_SHUFFLE(0, 0, 2, 1));
    const __m128 zxy = _mm_shuffle_ps(v, v, _MM_SHUFFLE(1, 1, 0, 2));
    return _mm_max_ps(_mm_max_ps(v, yzx), zxy);
  }

  void set_slabs(__m128 o, __m128 d, const SlabScene& scene) {
    constexpr float u = 0x1p-24F;
    const __m128 sign = _mm_set1_ps(-0.0F);
    const __m128 o_size = _mm_andnot_ps(sign, o);
    const __m128 below = _mm_andnot_ps(sign, _mm_sub_ps(_mm_load_ps(scene.lower.data()), o));
    const __m128 above = _mm_andnot_ps(sign, _mm_sub_ps(_mm_load_ps(scene.upper.data()), o));
    const __m128 reach = _mm_max_ps(below, above);
    const __m128 coordinates = _mm_max_ps(_mm_set1_ps(scene.reach), largest_of(o_size));
    const __m128 error =
        _mm_add_ps(_mm_add_ps(_mm_mul_ps(_mm_set1_ps(14 * u), reach), _mm_mul_ps(_mm_set1_ps(6 * u), largest_of(reach))),
                   _mm_add_ps(_mm_mul_ps(_mm_set1_ps(6 * u), o_size), _mm_set1_ps(std::numeric_limits<float>::min())));
    const __m128 least = _mm_max_ps(_mm_mul_ps(coordinates, _mm_set1_ps(0x1p-124F)), _mm_set1_ps(0x1p-100F));
    const __m128 d_sign = _mm_and_ps(sign, d);
    const __m128 component = _mm_or_ps(_mm_max_ps(_mm_andnot_ps(sign, d), least), d_sign);
    const __m128 inverse = _mm_div_ps(_mm_set1_ps(1), component);
    const __m128 displacement = _mm_or_ps(error, d_sign);
    _mm_store_ps(reciprocal.data(), inverse);
    _mm_store_ps(near_offset.data(), _mm_mul_ps(_mm_add_ps(o, displacement), inverse));
    _mm_store_ps(far_offset.data(), _mm_mul_ps(_mm_sub_ps(o, displacement), inverse));
    negative = static_cast<unsigned>(_mm_movemask_ps(d)) & 7U;
    if (!(_mm_cvtss_f32(coordinates) < SlabScene::largest)) [[unlikely]] {
      set_unbounded();
    }
  }

  /// From one end of the floats to the other in every box, but not in an empty slot, whose planes are infinite.
  void set_unbounded() {
    for (std::size_t i = 0; i < 3; ++i) {
      reciprocal[i] = std::copysign(std::numeric_limits<float>::min(), reciprocal[i]);
      near_offset[i] = std::numeric_limits<float>::max();
      far_offset[i] = -std::numeric_limits<float>::max();
    }
  }
};

}  // namespace raystudy::wide
