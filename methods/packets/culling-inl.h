// Boxes against rays side by side and against packets as a whole. Compiled once for each instruction set: no include guard in the
// usual sense.

#if defined(RAYSTUDY_PACKETS_CULLING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_PACKETS_CULLING_INL_H_
#undef RAYSTUDY_PACKETS_CULLING_INL_H_
#else
#define RAYSTUDY_PACKETS_CULLING_INL_H_
#endif

#include <algorithm>
#include <span>

#include "harness/accel/wide_bvh.h"
#include "methods/packets/ray_group-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {

/// The planes of one child's box, where they lie in a node of floats.
template <int W>
class ChildBox {
 public:
  ChildBox(const WideNode<W>& node, std::size_t slot) : first_(node.bounds[0][0].data() + slot) {}
  [[nodiscard]] HWY_INLINE float plane(std::size_t axis, std::size_t side) const { return first_[(2 * axis + side) * W]; }

 private:
  const float* first_;
};

/// The same of a node of 8 bits, or of any node: copied.
class BoxCopy {
 public:
  template <int W>
  HWY_INLINE BoxCopy(const QuantizedNode<W>& node, std::size_t slot) {
    for (std::size_t a = 0; a < 3; ++a) {
      const float scale = node.scale(static_cast<int>(a));
      for (std::size_t side = 0; side < 2; ++side) {
        planes_[2 * a + side] = node.origin[a] + scale * static_cast<float>(node.bounds[a][side][slot]);
      }
    }
  }
  [[nodiscard]] HWY_INLINE float plane(std::size_t axis, std::size_t side) const { return planes_[2 * axis + side]; }

 private:
  std::array<float, 6> planes_;
};

template <int W>
HWY_INLINE ChildBox<W> child_box(const WideNode<W>& node, std::size_t slot) {
  return {node, slot};
}

template <int W>
HWY_INLINE BoxCopy child_box(const QuantizedNode<W>& node, std::size_t slot) {
  return {node, slot};
}

/// One plane of as many children, from slot `lane` on.
template <class D, int W>
HWY_INLINE hn::Vec<D> child_planes(D d, const WideNode<W>& node, std::size_t axis, std::size_t side, std::size_t lane) {
  return hn::Load(d, node.bounds[axis][side].data() + lane);
}

template <class D, int W>
HWY_INLINE hn::Vec<D> child_planes(D d, const QuantizedNode<W>& node, std::size_t axis, std::size_t side, std::size_t lane) {
  const hn::Rebind<std::uint8_t, D> d8;
  const hn::Rebind<std::int32_t, D> d32;
  const auto steps = hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, node.bounds[axis][side].data() + lane)));
  return hn::MulAdd(steps, hn::Set(d, node.scale(static_cast<int>(axis))), hn::Set(d, node.origin[axis]));
}

/// Bits of the slots that hold a child.
template <int W>
HWY_INLINE unsigned used_slots(const WideNode<W>& node) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < W && node.child[i] != WideChild::none; ++i) bits |= 1U << i;
  return bits;
}

template <int W>
HWY_INLINE unsigned used_slots(const QuantizedNode<W>& node) {
  return (1U << static_cast<unsigned>(node.used())) - 1U;
}

/// Bits of the slots whose boxes may be met: the empty boxes of a node of floats never are, an empty slot of 8 bits looks as any.
template <int W>
HWY_INLINE unsigned testable_slots(const WideNode<W>&) {
  return (1U << static_cast<unsigned>(W)) - 1U;
}

template <int W>
HWY_INLINE unsigned testable_slots(const QuantizedNode<W>& node) {
  return used_slots(node);
}

/// Per axis: 0 where lower planes are entered first, else 1.
struct NearPlanes {
  std::array<std::size_t, 3> side;
  explicit NearPlanes(unsigned octant) : side{octant & 1U, (octant >> 1U) & 1U, (octant >> 2U) & 1U} {}
};

/// The lanes whose rays meet the box; `enter` gets where.
template <class D, class Box>
HWY_INLINE hn::Mask<D> meets(D d, const RayGroup<D>& group, const Box& box, const NearPlanes& near, hn::Vec<D>& enter) {
  const auto entered = [&](std::size_t a) {
    return hn::MulSub(hn::Set(d, box.plane(a, near.side[a])), hn::Load(d, group.reciprocal[a].data()),
                      hn::Load(d, group.near_offset[a].data()));
  };
  const auto left = [&](std::size_t a) {
    return hn::MulSub(hn::Set(d, box.plane(a, 1 - near.side[a])), hn::Load(d, group.reciprocal[a].data()),
                      hn::Load(d, group.far_offset[a].data()));
  };
  enter = hn::Max(hn::Max(entered(0), entered(1)), hn::Max(entered(2), hn::Load(d, group.near.data())));
  const auto leave = hn::Min(hn::Min(left(0), left(1)), hn::Min(left(2), hn::Load(d, group.far.data())));
  return hn::Le(enter, leave);
}

/// Slabs for all rays of a packet at once, by interval arithmetic: with origins o and reciprocals r in known intervals, a plane p
/// is met at some t = (p - o) r, the least and the greatest of which lie at the intervals' ends (Wald, Boulos, Shirley 2007,
/// Sec. 3.3). Origins are displaced as WideRay's, which covers the roundings here: (o r) and p r - (o r), fused or not.
struct PacketSlabs {
  std::array<std::array<float, 2>, 3> reciprocal;  ///< per axis: least and greatest
  std::array<std::array<float, 2>, 3> near_offset, far_offset;

  template <class D>
  HWY_INLINE PacketSlabs(D d, const SlabRanges<D>& ranges) {
    for (std::size_t a = 0; a < 3; ++a) {
      reciprocal[a] = {hn::GetLane(hn::MinOfLanes(d, ranges.least_reciprocal[a])),
                       hn::GetLane(hn::MaxOfLanes(d, ranges.greatest_reciprocal[a]))};
      const bool negative = ranges.negative[a];
      const float near =
          hn::GetLane(negative ? hn::MinOfLanes(d, ranges.near_origin[a]) : hn::MaxOfLanes(d, ranges.near_origin[a]));
      const float far = hn::GetLane(negative ? hn::MaxOfLanes(d, ranges.far_origin[a]) : hn::MinOfLanes(d, ranges.far_origin[a]));
      near_offset[a] = {near * reciprocal[a][0], near * reciprocal[a][1]};
      far_offset[a] = {far * reciprocal[a][0], far * reciprocal[a][1]};
      if (!ranges.bounded || !are_finite(near_offset[a]) || !are_finite(far_offset[a])) unbound(a, negative);
    }
  }

 private:
  static bool are_finite(const std::array<float, 2>& pair) { return std::isfinite(pair[0]) && std::isfinite(pair[1]); }

  /// From one end of the floats to the other, but not for an empty slot, whose planes are infinite.
  void unbound(std::size_t a, bool negative) {
    constexpr float end = std::numeric_limits<float>::max();
    reciprocal[a].fill(std::copysign(std::numeric_limits<float>::min(), negative ? -1.0F : 1.0F));
    near_offset[a].fill(end);
    far_offset[a].fill(-end);
  }
};

/// Tests all children of a node against a whole packet by its slabs: bit i tells that some ray may meet box i within [near, far]
/// of the boxes' t; enter[i] is a lower bound of where.
template <class Node>
HWY_INLINE unsigned cull_by_intervals(const Node& node, const PacketSlabs& slabs, const NearPlanes& sides, float near, float far,
                                      float* enter) {
  const FloatsOf<Node::width> d;
  unsigned bits = 0;
  for (std::size_t lane = 0; lane < Node::width; lane += hn::Lanes(d)) {
    const auto at = [&](std::size_t a, std::size_t side, const std::array<float, 2>& offset, std::size_t end) {
      return hn::MulSub(child_planes(d, node, a, side, lane), hn::Set(d, slabs.reciprocal[a][end]), hn::Set(d, offset[end]));
    };
    auto enters = hn::Set(d, near);
    auto leaves = hn::Set(d, far);
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t side = sides.side[a];
      enters = hn::Max(enters, hn::Min(at(a, side, slabs.near_offset[a], 0), at(a, side, slabs.near_offset[a], 1)));
      leaves = hn::Min(leaves, hn::Max(at(a, 1 - side, slabs.far_offset[a], 0), at(a, 1 - side, slabs.far_offset[a], 1)));
    }
    hn::Store(enters, d, enter + lane);
    bits |= mask_bits(d, hn::Le(enters, leaves)) << lane;
  }
  return bits & testable_slots(node);
}

/// The four planes around the rays of a packet that all follow one axis, two in each of the planes of coordinates through it:
/// with z along and x across, every point of a ray has x <= high_slope z + high_offset and x >= low_slope z + low_offset (compare
/// Reshetov, Soupikov, Hurley 2005, Sec. 3.2). Offsets leave room for the displacements that WideRay allows for, and the
/// roundings of the test.
struct PacketFrustum {
  struct Sides {
    std::size_t axis;
    float high_slope, high_offset, low_slope, low_offset;
    std::size_t high_z, low_z;  ///< which z plane of a box is the last to leave the frustum past its high and its low side
  };
  std::size_t along = 3;  ///< 3: no frustum
  std::array<Sides, 2> sides;

  /// `octant` as of the groups' rays.
  template <class D>
  HWY_INLINE PacketFrustum(D d, std::span<const RayGroup<D>> groups, unsigned octant, const wide::SlabScene& scene) {
    const std::size_t axis = common_axis(groups);
    if (axis == 3) return;
    along = axis;
    const std::size_t across = along == 2 ? 0 : along + 1;
    const std::size_t up = across == 2 ? 0 : across + 1;
    const bool negative = ((octant >> along) & 1U) != 0;
    set(d, groups, across, &RayGroup<D>::shear_across, negative, scene, sides[0]);
    set(d, groups, up, &RayGroup<D>::shear_up, negative, scene, sides[1]);
  }

 private:
  template <class D>
  static std::size_t common_axis(std::span<const RayGroup<D>> groups) {
    std::array<unsigned, 3> rays{};
    for (const auto& group : groups) {
      for (std::size_t a = 0; a < 3; ++a) rays[a] |= group.active & group.along[a];
    }
    if ((rays[1] | rays[2]) == 0) return 0;
    if ((rays[0] | rays[2]) == 0) return 1;
    return (rays[0] | rays[1]) == 0 ? 2 : 3;
  }

  template <class D>
  HWY_INLINE void set(D d, std::span<const RayGroup<D>> groups, std::size_t axis, typename RayGroup<D>::Row RayGroup<D>::*shear,
                      bool negative, const wide::SlabScene& scene, Sides& out) {
    using V = hn::Vec<D>;
    const V most = hn::Set(d, std::numeric_limits<float>::infinity());
    V least = most;
    V greatest = hn::Neg(most);
    V coordinates = hn::Set(d, scene.reach);
    for (const auto& group : groups) {
      const auto active = mask_of(d, group.active);
      const V slope = hn::Load(d, (group.*shear).data());
      least = hn::IfThenElse(active, hn::Min(least, slope), least);
      greatest = hn::IfThenElse(active, hn::Max(greatest, slope), greatest);
      const V size = hn::Max(hn::Abs(hn::Load(d, group.origin[axis].data())), hn::Abs(hn::Load(d, group.origin[along].data())));
      coordinates = hn::IfThenElse(active, hn::Max(coordinates, size), coordinates);
    }
    out.axis = axis;
    out.high_slope = hn::GetLane(negative ? hn::MinOfLanes(d, least) : hn::MaxOfLanes(d, greatest));
    out.low_slope = hn::GetLane(negative ? hn::MaxOfLanes(d, greatest) : hn::MinOfLanes(d, least));
    V high = hn::Neg(most);
    V low = most;
    for (const auto& group : groups) {
      const auto active = mask_of(d, group.active);
      const V x = hn::Load(d, group.origin[axis].data());
      const V z = hn::Load(d, group.origin[along].data());
      high = hn::IfThenElse(active, hn::Max(high, hn::NegMulAdd(z, hn::Set(d, out.high_slope), x)), high);
      low = hn::IfThenElse(active, hn::Min(low, hn::NegMulAdd(z, hn::Set(d, out.low_slope), x)), low);
    }
    // Slopes are at most 1. No distance is longer than 2 coordinates: displacements of 6 u (reach + farthest) <= 24 u coordinates
    // in x and in z, and some ten roundings of numbers up to 2 coordinates.
    const float margin = hn::GetLane(hn::MaxOfLanes(d, coordinates)) * (96 * 0x1p-24F) + std::numeric_limits<float>::min();
    out.high_offset = hn::GetLane(hn::MaxOfLanes(d, high)) + margin;
    out.low_offset = hn::GetLane(hn::MinOfLanes(d, low)) - margin;
    out.high_z = out.high_slope > 0 ? 1 : 0;
    out.low_z = out.low_slope > 0 ? 0 : 1;
  }
};

/// The same as cull_by_intervals by the planes around the rays, and by slabs along the axis they follow.
template <class Node>
HWY_INLINE unsigned cull_by_frustum(const Node& node, const PacketFrustum& frustum, const PacketSlabs& slabs,
                                    const NearPlanes& near_planes, float near, float far, float* enter) {
  const FloatsOf<Node::width> d;
  unsigned bits = 0;
  const std::size_t along = frustum.along;
  for (std::size_t lane = 0; lane < Node::width; lane += hn::Lanes(d)) {
    const std::array z{child_planes(d, node, along, 0, lane), child_planes(d, node, along, 1, lane)};
    const std::size_t side = near_planes.side[along];
    const auto at = [&](std::size_t plane, const std::array<float, 2>& offset, std::size_t end) {
      return hn::MulSub(z[plane], hn::Set(d, slabs.reciprocal[along][end]), hn::Set(d, offset[end]));
    };
    const auto& near_offset = slabs.near_offset[along];
    const auto& far_offset = slabs.far_offset[along];
    const auto enters = hn::Max(hn::Set(d, near), hn::Min(at(side, near_offset, 0), at(side, near_offset, 1)));
    const auto leaves = hn::Min(hn::Set(d, far), hn::Max(at(1 - side, far_offset, 0), at(1 - side, far_offset, 1)));
    auto met = hn::Le(enters, leaves);
    for (const PacketFrustum::Sides& sides : frustum.sides) {
      const auto low = child_planes(d, node, sides.axis, 0, lane);
      const auto high = child_planes(d, node, sides.axis, 1, lane);
      const auto below = hn::NegMulAdd(z[sides.high_z], hn::Set(d, sides.high_slope), low);
      const auto above = hn::NegMulAdd(z[sides.low_z], hn::Set(d, sides.low_slope), high);
      met = hn::And(met, hn::And(hn::Le(below, hn::Set(d, sides.high_offset)), hn::Ge(above, hn::Set(d, sides.low_offset))));
    }
    hn::Store(enters, d, enter + lane);
    bits |= mask_bits(d, met) << lane;
  }
  return bits & testable_slots(node);
}

}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
