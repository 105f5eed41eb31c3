// The triangles of a leaf against one ray of a group after the other. Compiled once for each instruction set (Highway's
// foreach_target): no include guard in the usual sense.

#if defined(RAYSTUDY_STREAMS_LEAF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_STREAMS_LEAF_INL_H_
#undef RAYSTUDY_STREAMS_LEAF_INL_H_
#else
#define RAYSTUDY_STREAMS_LEAF_INL_H_
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "methods/packets/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::streams::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace many = packets::HWY_NAMESPACE;

/// As many triangles of a leaf as a vector has lanes, in registers for all the rays of a stream that meet the leaf:
/// they have their longest axis in common, so that each needs the same rows.
template <class D, class Group>
class LeafTriangles {
 public:
  static constexpr std::uint32_t lanes = many::lanes_of<D>;
  using DepthRows = std::array<typename Group::Row, 4>;  ///< the wide::Depths of a group's rays: their members in order

  /// For rays that follow axis `along`, the triangles of leaf `child` from `begin` on.
  HWY_INLINE LeafTriangles(const wide::Tree& tree, std::uint32_t child, std::uint32_t begin, std::size_t along)
      : ids_(tree.triangles + WideChild::first(child) + begin),
        used_((1U << std::min<std::uint32_t>(lanes, WideChild::count(child) - begin)) - 1U),
        axes_{along == 2 ? 0 : along + 1, along == 0 ? 2 : along - 1, along} {
    const D d;
    const float* const rows = tree.corners + std::size_t{9} * WideChild::first(child) + begin;
    const std::size_t stride = WideChild::count(child);
    for (std::size_t c = 0; c < 3; ++c) {
      corners_.x[c] = hn::LoadU(d, rows + stride * (3 * axes_[0] + c));
      corners_.y[c] = hn::LoadU(d, rows + stride * (3 * axes_[1] + c));
      corners_.z[c] = hn::LoadU(d, rows + stride * (3 * axes_[2] + c));
    }
  }

  /// Bits of triangles.
  struct Verdict {
    unsigned met;   ///< surely
    unsigned open;  ///< neither met nor ruled out
  };

  /// What the signs of the rounded edge functions say (watertight.h) for the ray in a lane.
  HWY_INLINE Verdict judge(const Group& group, std::size_t lane) const {
    const D d;
    return {0, used_ & ~many::mask_bits(d, edges(sheared(group, lane)).outside(d))};
  }

  /// The same, and what the corners' depths say.
  HWY_INLINE Verdict judge(const Group& group, const DepthRows& depths, std::size_t lane) const {
    const D d;
    const auto limit = [&](std::size_t i) { return hn::Set(d, depths[i][lane]); };
    const Corners corners = sheared(group, lane);
    const V shallowest = hn::Min(hn::Min(corners.z[0], corners.z[1]), corners.z[2]);
    const V deepest = hn::Max(hn::Max(corners.z[0], corners.z[1]), corners.z[2]);
    const auto out = hn::Or(hn::Gt(shallowest, limit(1)), hn::Lt(deepest, limit(0)));
    const auto in = hn::And(hn::Gt(shallowest, limit(2)), hn::Lt(deepest, limit(3)));
    const Edges signs = edges(corners);
    const unsigned met = used_ & many::mask_bits(d, hn::And(signs.inside(d), in));
    return {met, used_ & ~met & ~many::mask_bits(d, hn::Or(signs.outside(d), out))};
  }

  /// Takes one of the triangles that the ray surely meets, of which there are some, for any hit.
  HWY_INLINE void take_any(Group& group, std::size_t lane, unsigned met) const {
    group.triangle[lane] = ids_[static_cast<std::size_t>(std::countr_zero(met))];
  }

  /// Decides the candidates, of which there are some; true where the ray found a nearer hit. Of any hits it takes the first.
  template <bool any>
  HWY_INLINE bool decide(Group& group, std::size_t lane, unsigned candidates) const {
    const D d;
    Meetings found;
    meet(group, lane, found);
    const V t = hn::Load(d, found.t.data());
    const auto within = hn::And(hn::And(hn::Ge(t, hn::Set(d, group.tmin[lane])), hn::Le(t, hn::Set(d, group.t[lane]))),
                                hn::Lt(t, hn::Set(d, std::numeric_limits<float>::infinity())));
    unsigned met = candidates & many::mask_bits(d, within);
    if constexpr (any) {
      if (met == 0) return false;
      take_any(group, lane, met);
      return true;
    } else {
      bool nearer = false;
      for (; met != 0; met &= met - 1) nearer |= take(group, lane, found, static_cast<std::size_t>(std::countr_zero(met)));
      return nearer;
    }
  }

 private:
  using V = hn::Vec<D>;
  using Corners = many::ShearedCorners<D>;

  /// The least and the greatest edge function of each triangle. Signs that are not 0 are right.
  struct Edges {
    V least, greatest;
    [[nodiscard]] HWY_INLINE auto outside(D d) const {
      return hn::And(hn::Lt(least, hn::Zero(d)), hn::Gt(greatest, hn::Zero(d)));
    }
    [[nodiscard]] HWY_INLINE auto inside(D d) const { return hn::Or(hn::Gt(least, hn::Zero(d)), hn::Lt(greatest, hn::Zero(d))); }
  };

  HWY_INLINE static Edges edges(const Corners& corners) {
    const auto edge = [&](std::size_t p, std::size_t q) {
      return hn::Sub(hn::Mul(corners.x[q], corners.y[p]), hn::Mul(corners.y[q], corners.x[p]));
    };
    const V u = edge(1, 2);
    const V v = edge(2, 0);
    const V w = edge(0, 1);
    return {hn::Min(hn::Min(u, v), w), hn::Max(hn::Max(u, v), w)};
  }

  /// Where the ray meets the triangles: t is NaN where it does not; u = b / area, v = c / area.
  struct Meetings {
    alignas(64) std::array<float, lanes> t;
    alignas(64) std::array<double, lanes> b, c, area;
  };

  HWY_INLINE Corners sheared(const Group& group, std::size_t lane) const {
    const D d;
    const V ox = hn::Set(d, group.origin[axes_[0]][lane]);
    const V oy = hn::Set(d, group.origin[axes_[1]][lane]);
    const V oz = hn::Set(d, group.origin[axes_[2]][lane]);
    const V sx = hn::Set(d, group.shear_across[lane]);
    const V sy = hn::Set(d, group.shear_up[lane]);
    Corners corners;
    for (std::size_t c = 0; c < 3; ++c) {
      corners.z[c] = hn::Sub(corners_.z[c], oz);
      corners.x[c] = hn::Sub(hn::Sub(corners_.x[c], ox), hn::Mul(sx, corners.z[c]));
      corners.y[c] = hn::Sub(hn::Sub(corners_.y[c], oy), hn::Mul(sy, corners.z[c]));
    }
    return corners;
  }

  HWY_INLINE void meet(const Group& group, std::size_t lane, Meetings& found) const {
    const D d;
    const Corners corners = sheared(group, lane);
    const V direction_along = hn::Set(d, group.direction_along[lane]);
    if constexpr (hn::MaxLanes(hn::ScalableTag<double>()) >= lanes) {
      put(many::finish_half(d, corners, direction_along), d, 0, found);
    } else {
      const hn::Half<D> dh;
      const auto lower = [&](V v) { return hn::LowerHalf(dh, v); };
      const auto upper = [&](V v) { return hn::UpperHalf(dh, v); };
      put(many::finish_half(dh, many::half_of(corners, lower), lower(direction_along)), dh, 0, found);
      put(many::finish_half(dh, many::half_of(corners, upper), upper(direction_along)), dh, lanes / 2, found);
    }
  }

  template <class DT>
  HWY_INLINE static void put(const many::HalfMeetings<DT>& some, DT dt, std::size_t begin, Meetings& found) {
    const hn::Rebind<double, DT> dd;
    hn::Store(some.t, dt, found.t.data() + begin);
    hn::Store(some.b, dd, found.b.data() + begin);
    hn::Store(some.c, dd, found.c.data() + begin);
    hn::Store(some.area, dd, found.area.data() + begin);
  }

  /// Of equal distances the lowest triangle is the hit.
  HWY_INLINE bool take(Group& group, std::size_t lane, const Meetings& found, std::size_t i) const {
    const float t = found.t[i];
    if (!(t < group.t[lane] || (t == group.t[lane] && ids_[i] < group.triangle[lane]))) return false;
    group.t[lane] = t;
    group.triangle[lane] = ids_[i];
    group.far[lane] = t * group.scale[lane];
    group.b[lane] = found.b[i];
    group.c[lane] = found.c[i];
    group.area[lane] = found.area[i];
    return true;
  }

  const std::uint32_t* ids_;
  unsigned used_;                    ///< lanes that hold a triangle
  std::array<std::size_t, 3> axes_;  ///< across, up, along
  Corners corners_;
};

}  // namespace raystudy::streams::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
