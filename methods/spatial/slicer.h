#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/scene/scene.h"
#include "methods/topdown/box_record.h"

namespace raystudy::spatial {

namespace hn = topdown::hn;
using topdown::BoxRecord;
using topdown::Float4;
using topdown::WideBox;

/// The corners of a triangle.
struct Corners {
  std::array<hn::Vec<Float4>, 3> at;

  Corners(const Scene& scene, std::uint32_t triangle) {
    const Triangle& t = scene.triangles[triangle];
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = scene.vertices[t[i]];
      at[static_cast<std::size_t>(i)] = std::bit_cast<hn::Vec<Float4>>(std::array<float, 4>{v.x, v.y, v.z, 0});
    }
  }
};

/// Bounds of some points, not negated.
struct Extent {
  hn::Vec<Float4> lower;
  hn::Vec<Float4> upper;
};

/// A triangle to be cut across an axis. A plane meets its edge from the lowest to the highest corner and the way from the one to
/// the other by the middle corner, so that the part between two planes is bounded by four points, and by the middle corner where
/// it lies between them. Without a branch, since nothing of a triangle can be predicted.
class Slicer {
 public:
  Slicer(const Corners& corners, int axis) {
    const Float4 d;
    const std::int32_t lane[4] = {axis, axis, axis, axis};
    const auto coordinate = [&, index = hn::SetTableIndices(d, lane)](hn::Vec<Float4> v) {
      return hn::TableLookupLanes(v, index);
    };
    low_ = corners.at[0];
    middle_ = corners.at[1];
    auto high = corners.at[2];
    const auto sort = [&](hn::Vec<Float4>& a, hn::Vec<Float4>& b) {
      const auto swap = hn::Lt(coordinate(b), coordinate(a));
      const auto first = hn::IfThenElse(swap, b, a);
      b = hn::IfThenElse(swap, a, b);
      a = first;
    };
    sort(low_, middle_);
    sort(middle_, high);
    sort(low_, middle_);
    whole_ = hn::Sub(high, low_);
    first_ = hn::Sub(middle_, low_);
    second_ = hn::Sub(high, middle_);
    magnitude_ = hn::Max(hn::Max(hn::Abs(low_), hn::Abs(middle_)), hn::Abs(high));
    middle_at_ = coordinate(middle_);
    const auto lanes = hn::Iota(d, 0);
    begin_ = hn::IfThenElse(hn::Eq(lanes, hn::Set(d, 2.0F)), middle_at_, coordinate(low_));
    length_ = hn::Sub(hn::IfThenElse(hn::Eq(lanes, hn::Set(d, 1.0F)), middle_at_, coordinate(high)), begin_);
  }

  /// The triangle in the plane at `at`, which is in all lanes; a plane past its corners counts as at them.
  [[nodiscard]] Extent cut(hn::Vec<Float4> at) const {
    const Float4 d;
    // How far along each edge. One within the plane has no number for that: any of its points will do, since its corners count
    // too.
    const auto t = hn::Max(hn::Min(hn::Div(hn::Sub(at, begin_), length_), hn::Set(d, 1.0F)), hn::Zero(d));
    const auto a = hn::Add(low_, hn::Mul(whole_, hn::Broadcast<0>(t)));
    const auto b = hn::Add(hn::Add(low_, hn::Mul(first_, hn::Broadcast<1>(t))), hn::Mul(second_, hn::Broadcast<2>(t)));
    return {hn::Min(a, b), hn::Max(a, b)};
  }

  /// The part between two planes whose cuts are known.
  [[nodiscard]] Extent between(hn::Vec<Float4> from, const Extent& first_cut, hn::Vec<Float4> to, const Extent& last_cut) const {
    const auto has_middle = hn::And(hn::Le(from, middle_at_), hn::Le(middle_at_, to));
    const auto point = hn::IfThenElse(has_middle, middle_, first_cut.lower);
    return {hn::Min(hn::Min(first_cut.lower, last_cut.lower), point), hn::Max(hn::Max(first_cut.upper, last_cut.upper), point)};
  }

  /// By how much the coordinates of a cut may be wrong, with room to spare. With u = 2⁻²⁴ and M the largest coordinate of a
  /// corner, t is wrong by 3 u of itself, steps along edges of length <= 2 M by 12 u M, and their sums by 2 u M; besides, by what
  /// denormal numbers lack.
  [[nodiscard]] hn::Vec<Float4> error() const {
    const Float4 d;
    return hn::Add(hn::Mul(magnitude_, hn::Set(d, 0x1p-19F)), hn::Set(d, 4 * std::numeric_limits<float>::denorm_min()));
  }

 private:
  hn::Vec<Float4> low_;
  hn::Vec<Float4> middle_;
  hn::Vec<Float4> whole_;   ///< from the lowest corner to the highest
  hn::Vec<Float4> first_;   ///< from the lowest to the middle one
  hn::Vec<Float4> second_;  ///< from the middle to the highest
  hn::Vec<Float4> magnitude_;
  hn::Vec<Float4> middle_at_;
  hn::Vec<Float4> begin_;  ///< of each of these three edges, along the axis
  hn::Vec<Float4> length_;
};

/// Two boxes that together hold what `record`'s box holds of its triangle, on either side of the plane at `at`, which lies inside
/// the box. They hold all of it whatever rounding does, and meet in the plane itself. Where nothing is on a side, that box may
/// be empty.
[[nodiscard]] std::array<WideBox, 2> chopped(const Scene& scene, const BoxRecord& record, int axis, float at);

}  // namespace raystudy::spatial
