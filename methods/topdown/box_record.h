#pragma once

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/base/aligned.h"
#include "harness/geometry/box.h"

namespace raystudy::topdown {

namespace hn = hwy::HWY_NAMESPACE;
using Float4 = hn::FixedTag<float, 4>;
using Int4 = hn::FixedTag<std::int32_t, 4>;

/// A triangle's box as its lower and its negated upper bounds: the union of two is then one minimum of all of a record. The
/// fourth lane of a half holds no coordinate; nothing is ever computed from it.
struct alignas(32) BoxRecord {
  float lower[3];
  std::uint32_t triangle;  ///< index into Scene::triangles
  float negated_upper[3];
  std::uint32_t rank;  ///< scratch of the builder

  [[nodiscard]] static BoxRecord of(const Box& box, std::uint32_t triangle) {
    // 0 is added so that no -0 is left: which of the two a minimum returns would depend on the order of the boxes.
    const Vec3 lower = box.lower + Vec3{};
    const Vec3 upper = box.upper + Vec3{};
    return {{lower.x, lower.y, lower.z}, triangle, {-upper.x, -upper.y, -upper.z}, 0};
  }
};
static_assert(sizeof(BoxRecord) == 32);

using BoxRecords = AlignedRoom<BoxRecord>;

#if HWY_MAX_BYTES >= 32
/// A box in one vector register, laid out as BoxRecord; the fourth lanes of the halves are meaningless.
struct WideBox {
  using Float8 = hn::FixedTag<float, 8>;
  hn::Vec<Float8> bounds;

  [[nodiscard]] static WideBox of(const BoxRecord& record) {
    return {hn::Load(Float8(), reinterpret_cast<const float*>(&record))};
  }
  [[nodiscard]] static WideBox of(hn::Vec<Float4> lower, hn::Vec<Float4> negated_upper) {
    return {hn::Combine(Float8(), negated_upper, lower)};
  }
  [[nodiscard]] static WideBox empty() { return {hn::Set(Float8(), std::numeric_limits<float>::infinity())}; }
  void store(BoxRecord& record) const { hn::Store(bounds, Float8(), reinterpret_cast<float*>(&record)); }
  [[nodiscard]] hn::Vec<Float4> lower() const { return hn::LowerHalf(Float4(), bounds); }
  [[nodiscard]] hn::Vec<Float4> negated_upper() const { return hn::UpperHalf(Float4(), bounds); }
  [[nodiscard]] friend WideBox united(const WideBox& a, const WideBox& b) { return {hn::Min(a.bounds, b.bounds)}; }
  [[nodiscard]] friend WideBox common(const WideBox& a, const WideBox& b) { return {hn::Max(a.bounds, b.bounds)}; }
#else
/// A box in two vector registers, laid out as BoxRecord; the fourth lanes are meaningless.
struct WideBox {
  hn::Vec<Float4> halves[2];

  [[nodiscard]] static WideBox of(const BoxRecord& record) {
    const auto* p = reinterpret_cast<const float*>(&record);
    return {{hn::Load(Float4(), p), hn::Load(Float4(), p + 4)}};
  }
  [[nodiscard]] static WideBox of(hn::Vec<Float4> lower, hn::Vec<Float4> negated_upper) { return {{lower, negated_upper}}; }
  [[nodiscard]] static WideBox empty() {
    const auto infinity = hn::Set(Float4(), std::numeric_limits<float>::infinity());
    return {{infinity, infinity}};
  }
  void store(BoxRecord& record) const {
    auto* p = reinterpret_cast<float*>(&record);
    hn::Store(halves[0], Float4(), p);
    hn::Store(halves[1], Float4(), p + 4);
  }
  [[nodiscard]] hn::Vec<Float4> lower() const { return halves[0]; }
  [[nodiscard]] hn::Vec<Float4> negated_upper() const { return halves[1]; }
  [[nodiscard]] friend WideBox united(const WideBox& a, const WideBox& b) {
    return {{hn::Min(a.halves[0], b.halves[0]), hn::Min(a.halves[1], b.halves[1])}};
  }
  [[nodiscard]] friend WideBox common(const WideBox& a, const WideBox& b) {
    return {{hn::Max(a.halves[0], b.halves[0]), hn::Max(a.halves[1], b.halves[1])}};
  }
#endif

  /// Whether it holds no point, as what two boxes have in common may.
  [[nodiscard]] bool is_empty() const {
    const Float4 d;
    return !hn::AllFalse(d, hn::And(hn::Gt(lower(), hn::Neg(negated_upper())), hn::FirstN(d, 3)));
  }

  [[nodiscard]] Box box() const {
    BoxRecord r;
    store(r);
    return {{r.lower[0], r.lower[1], r.lower[2]}, {-r.negated_upper[0], -r.negated_upper[1], -r.negated_upper[2]}};
  }
};

/// The first three lanes of four vectors, transposed.
struct Lanes {
  hn::Vec<Float4> x;
  hn::Vec<Float4> y;
  hn::Vec<Float4> z;

  Lanes(hn::Vec<Float4> v0, hn::Vec<Float4> v1, hn::Vec<Float4> v2, hn::Vec<Float4> v3) {
    const Float4 d;
    const auto xy01 = hn::InterleaveLower(d, v0, v1);  // x0 x1 y0 y1
    const auto xy23 = hn::InterleaveLower(d, v2, v3);
    const auto z01 = hn::InterleaveUpper(d, v0, v1);
    const auto z23 = hn::InterleaveUpper(d, v2, v3);
    x = hn::ConcatLowerLower(d, xy23, xy01);
    y = hn::ConcatUpperUpper(d, xy23, xy01);
    z = hn::ConcatLowerLower(d, z23, z01);
  }
};

/// Box::half_area of four boxes, bit for bit.
[[nodiscard]] inline hn::Vec<Float4> half_areas(const WideBox& b0, const WideBox& b1, const WideBox& b2, const WideBox& b3) {
  // The negated extents, whose products are those of the extents, of four boxes at once.
  const auto extent = [](const WideBox& b) { return hn::Add(b.lower(), b.negated_upper()); };
  const Lanes e(extent(b0), extent(b1), extent(b2), extent(b3));
  return hn::Add(hn::Add(hn::Mul(e.x, e.y), hn::Mul(e.y, e.z)), hn::Mul(e.z, e.x));
}

/// Grows `acc` by four boxes one after another and returns the half areas of the four states on the way: of the first in lane 0,
/// or with `reversed` of the first in lane 3.
template <bool reversed>
[[nodiscard]] inline hn::Vec<Float4> grow(WideBox& acc, const WideBox& b0, const WideBox& b1, const WideBox& b2,
                                          const WideBox& b3) {
  // Two boxes are united apart from `acc`: the chain of dependent instructions is then two a step instead of four.
  const WideBox s0 = united(acc, b0);
  const WideBox s1 = united(acc, united(b0, b1));
  const WideBox s2 = united(s1, b2);
  const WideBox s3 = united(s1, united(b2, b3));
  acc = s3;
  return reversed ? half_areas(s3, s2, s1, s0) : half_areas(s0, s1, s2, s3);
}

}  // namespace raystudy::topdown
