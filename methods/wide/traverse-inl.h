// Traversal of wide trees, compiled once for each instruction set (Highway's foreach_target): no include guard in the usual
// sense.

#if defined(RAYSTUDY_WIDE_TRAVERSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_WIDE_TRAVERSE_INL_H_
#undef RAYSTUDY_WIDE_TRAVERSE_INL_H_
#else
#define RAYSTUDY_WIDE_TRAVERSE_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "harness/accel/wide_bvh.h"
#include "harness/geometry/watertight.h"
#include "methods/wide/kernels.h"
#include "methods/wide/wide_ray.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::wide::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Lanes of a vector over `n` slots: n, or as many as the instruction set has.
template <int n>
using FloatsOf = hn::CappedTag<float, n>;

/// Bit i: lane i of the mask. Through a register, not by way of memory (StoreMaskBits), for which every node would wait.
template <class M>
HWY_INLINE unsigned mask_bits(M mask) {
#if HWY_TARGET <= HWY_AVX3
  return mask.raw;
#else
  return static_cast<unsigned>(hn::detail::BitsFromMask(mask));
#endif
}

/// A ray's slab constants in all lanes, and where the near planes of each axis lie in a node.
template <class D>
struct SlabVectors {
  using V = hn::Vec<D>;
  V rx, ry, rz, nx, ny, nz, fx, fy, fz;
  std::size_t x, y, z;

  HWY_INLINE SlabVectors(D d, const WideRay& ray)
      : rx(hn::Set(d, ray.reciprocal[0])),
        ry(hn::Set(d, ray.reciprocal[1])),
        rz(hn::Set(d, ray.reciprocal[2])),
        nx(hn::Set(d, ray.near_offset[0])),
        ny(hn::Set(d, ray.near_offset[1])),
        nz(hn::Set(d, ray.near_offset[2])),
        fx(hn::Set(d, ray.far_offset[0])),
        fy(hn::Set(d, ray.far_offset[1])),
        fz(hn::Set(d, ray.far_offset[2])),
        x(ray.negative & 1U),
        y((ray.negative >> 1U) & 1U),
        z(ray.negative >> 2U) {}
};

/// Where boxes are entered and left, within the limits of the ray; a box is met where enter <= leave.
template <class D>
struct Slabs {
  hn::Vec<D> enter;
  hn::Vec<D> leave;
  [[nodiscard]] HWY_INLINE auto met() const { return hn::Le(enter, leave); }
};

/// Tests the boxes of the slots from `lane` on against the part of the ray in [tmin, tmax] of the boxes' t.
template <class D, int W>
HWY_INLINE Slabs<D> test_boxes(D d, const WideNode<W>& node, std::size_t lane, const SlabVectors<D>& ray, hn::Vec<D> tmin,
                               hn::Vec<D> tmax) {
  const auto plane = [&](std::size_t axis, std::size_t side) { return hn::Load(d, node.bounds[axis][side].data() + lane); };
  const auto enter_x = hn::MulSub(plane(0, ray.x), ray.rx, ray.nx);
  const auto enter_y = hn::MulSub(plane(1, ray.y), ray.ry, ray.ny);
  const auto enter_z = hn::MulSub(plane(2, ray.z), ray.rz, ray.nz);
  const auto leave_x = hn::MulSub(plane(0, 1 - ray.x), ray.rx, ray.fx);
  const auto leave_y = hn::MulSub(plane(1, 1 - ray.y), ray.ry, ray.fy);
  const auto leave_z = hn::MulSub(plane(2, 1 - ray.z), ray.rz, ray.fz);
  return {hn::Max(hn::Max(enter_x, enter_y), hn::Max(enter_z, tmin)), hn::Min(hn::Min(leave_x, leave_y), hn::Min(leave_z, tmax))};
}

/// The 8-bit planes on a node's own grid: its scale is a power of two, so that scale · reciprocal is exact.
template <class D, int W>
HWY_INLINE Slabs<D> test_boxes(D d, const QuantizedNode<W>& node, std::size_t lane, const SlabVectors<D>& ray, hn::Vec<D> tmin,
                               hn::Vec<D> tmax) {
  const hn::Rebind<std::uint8_t, D> d8;
  const hn::Rebind<std::int32_t, D> d32;
  const auto plane = [&](std::size_t axis, std::size_t side) {
    return hn::ConvertTo(d, hn::PromoteTo(d32, hn::LoadU(d8, node.bounds[axis][side].data() + lane)));
  };
  const auto ox = hn::Set(d, node.origin[0]);
  const auto oy = hn::Set(d, node.origin[1]);
  const auto oz = hn::Set(d, node.origin[2]);
  const auto sx = hn::Mul(ray.rx, hn::Set(d, node.scale(0)));
  const auto sy = hn::Mul(ray.ry, hn::Set(d, node.scale(1)));
  const auto sz = hn::Mul(ray.rz, hn::Set(d, node.scale(2)));
  const auto enter_x = hn::MulAdd(plane(0, ray.x), sx, hn::MulSub(ox, ray.rx, ray.nx));
  const auto enter_y = hn::MulAdd(plane(1, ray.y), sy, hn::MulSub(oy, ray.ry, ray.ny));
  const auto enter_z = hn::MulAdd(plane(2, ray.z), sz, hn::MulSub(oz, ray.rz, ray.nz));
  const auto leave_x = hn::MulAdd(plane(0, 1 - ray.x), sx, hn::MulSub(ox, ray.rx, ray.fx));
  const auto leave_y = hn::MulAdd(plane(1, 1 - ray.y), sy, hn::MulSub(oy, ray.ry, ray.fy));
  const auto leave_z = hn::MulAdd(plane(2, 1 - ray.z), sz, hn::MulSub(oz, ray.rz, ray.fz));
  const auto enter = hn::Max(hn::Max(enter_x, enter_y), hn::Max(enter_z, tmin));
  const auto leave = hn::Min(hn::Min(leave_x, leave_y), hn::Min(leave_z, tmax));
  const auto used = static_cast<std::size_t>(node.used());
  return {hn::IfThenElse(hn::FirstN(d, used > lane ? used - lane : 0), enter, hn::Inf(d)), leave};
}

/// A ray's constants of the watertight test in all lanes.
template <class D>
struct ShearVectors {
  using V = hn::Vec<D>;
  V ox, oy, oz, sx, sy;

  HWY_INLINE ShearVectors(D d, const TriangleRay& ray)
      : ox(hn::Set(d, ray.origin[0])),
        oy(hn::Set(d, ray.origin[1])),
        oz(hn::Set(d, ray.origin[2])),
        sx(hn::Set(d, ray.shear_across)),
        sy(hn::Set(d, ray.shear_up)) {}
};

/// Where along its longest axis, from the origin, a ray meets nothing outside of `low` to `high`, and what it surely can meet
/// inside of `inner_low` to `inner_high`. A hit's t is, but for a rounding, a mean of its corners' depths over the direction's
/// component, so that corners which are all beyond a limit are out, and corners which are all within are in. The margins are far
/// larger than the roundings.
template <class D>
struct Depths {
  using V = hn::Vec<D>;
  V low, high, inner_low, inner_high;

  HWY_INLINE Depths(D d, V direction_along, V tmin, V tmax) {
    const V largest = hn::Set(d, std::numeric_limits<float>::max());
    const V a = hn::Mul(tmin, direction_along);
    const V b = hn::Min(hn::Max(hn::Mul(tmax, direction_along), hn::Neg(largest)), largest);
    const V from = hn::Min(a, b);
    const V to = hn::Max(a, b);
    const auto margin = [&](V at) {
      return hn::Add(hn::Mul(hn::Abs(at), hn::Set(d, 0x1p-20F)), hn::Set(d, std::numeric_limits<float>::min()));
    };
    low = hn::Sub(from, margin(from));
    high = hn::Add(to, margin(to));
    inner_low = hn::Add(from, margin(from));
    inner_high = hn::Sub(to, margin(to));
  }
};

/// Tests a leaf's triangles, as many at a time as a vector has lanes, by the signs of the edge functions (watertight.h) and by
/// depth; the few that are left are decided one by one, with the very roundings of the scalar test. Signs that are not 0 are
/// right, which for an any hit decides most triangles at once. True where a nearer hit was found.
template <bool any, class D>
HWY_INLINE bool test_leaf(D d, const Tree& tree, std::uint32_t child, const TriangleRay& ray, const ShearVectors<D>& shear,
                          float tmin, Hit& hit) {
  const std::uint32_t first = WideChild::first(child);
  const std::uint32_t n = WideChild::count(child);
  const float* const rows = tree.corners + std::size_t{9} * first;
  const Depths<D> depths(d, hn::Set(d, ray.direction_along), hn::Set(d, tmin), hn::Set(d, hit.t));
  bool nearer = false;
  for (std::uint32_t begin = 0; begin < n; begin += static_cast<std::uint32_t>(hn::Lanes(d))) {
    const auto row = [&](int axis, int corner) {
      return hn::LoadU(d, rows + begin + std::size_t{n} * static_cast<std::size_t>(3 * axis + corner));
    };
    const auto az = hn::Sub(row(ray.along, 0), shear.oz);
    const auto bz = hn::Sub(row(ray.along, 1), shear.oz);
    const auto cz = hn::Sub(row(ray.along, 2), shear.oz);
    const auto ax = hn::Sub(hn::Sub(row(ray.across, 0), shear.ox), hn::Mul(shear.sx, az));
    const auto bx = hn::Sub(hn::Sub(row(ray.across, 1), shear.ox), hn::Mul(shear.sx, bz));
    const auto cx = hn::Sub(hn::Sub(row(ray.across, 2), shear.ox), hn::Mul(shear.sx, cz));
    const auto ay = hn::Sub(hn::Sub(row(ray.up, 0), shear.oy), hn::Mul(shear.sy, az));
    const auto by = hn::Sub(hn::Sub(row(ray.up, 1), shear.oy), hn::Mul(shear.sy, bz));
    const auto cy = hn::Sub(hn::Sub(row(ray.up, 2), shear.oy), hn::Mul(shear.sy, cz));
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto zero = hn::Zero(d);
    const auto negative = hn::Or(hn::Or(hn::Lt(u, zero), hn::Lt(v, zero)), hn::Lt(w, zero));
    const auto positive = hn::Or(hn::Or(hn::Gt(u, zero), hn::Gt(v, zero)), hn::Gt(w, zero));
    const auto shallowest = hn::Min(hn::Min(az, bz), cz);
    const auto deepest = hn::Max(hn::Max(az, bz), cz);
    const auto out = hn::Or(hn::Gt(shallowest, depths.high), hn::Lt(deepest, depths.low));
    const unsigned lanes = (1U << std::min<std::uint32_t>(n - begin, static_cast<std::uint32_t>(hn::Lanes(d)))) - 1U;
    unsigned candidates = ~mask_bits(hn::Or(hn::And(negative, positive), out)) & lanes;
    if constexpr (any) {
      const auto in = hn::And(hn::Gt(shallowest, depths.inner_low), hn::Lt(deepest, depths.inner_high));
      const auto signs = hn::And(hn::And(hn::Ne(u, zero), hn::Ne(v, zero)), hn::Ne(w, zero));
      const unsigned certain = candidates & mask_bits(hn::And(in, signs));
      if (certain != 0) {
        hit.triangle = tree.triangles[first + begin + static_cast<std::uint32_t>(std::countr_zero(certain))];
        return true;
      }
    }
    while (candidates != 0) {
      const auto i = begin + static_cast<std::uint32_t>(std::countr_zero(candidates));
      candidates &= candidates - 1;
      nearer |= finish_triangle(rows, n, i, tree.triangles[first + i], ray, tmin, hit);
    }
  }
  return nearer;
}

/// Children that can wait in a tree, and room past them for what a vector writes of a whole node's.
[[nodiscard]] inline std::size_t stack_room(const Tree& tree, std::size_t width) {
  return std::size_t{tree.height} * (width - 1) + 1 + 2 * width;
}

/// A child that waits for its turn.
struct Pending {
  std::uint32_t child;
  float near;
};

/// Puts all children of `met` on the stack but the one in the last slot, and returns that.
template <class Node>
HWY_INLINE std::uint32_t push_by_slot(const Node& node, unsigned met, Pending*& top) {
  const auto slot = [&] { return static_cast<std::size_t>(std::countr_zero(met)); };
  for (; (met & (met - 1)) != 0; met &= met - 1) *top++ = {node.child[slot()], 0};
  return node.child[slot()];
}

/// The same with the nearest child, and the others sorted, the nearest on top.
template <class Node>
HWY_INLINE std::uint32_t push_by_distance(const Node& node, unsigned met, const std::array<float, Node::width>& near,
                                          Pending*& top) {
  auto slot = static_cast<std::size_t>(std::countr_zero(met));
  Pending nearest{node.child[slot], near[slot]};
  Pending* const bottom = top;
  for (met &= met - 1; met != 0; met &= met - 1) {
    slot = static_cast<std::size_t>(std::countr_zero(met));
    Pending next{node.child[slot], near[slot]};
    if (next.near < nearest.near) std::swap(next, nearest);
    Pending* at = top++;
    for (; at > bottom && at[-1].near < next.near; --at) *at = at[-1];
    *at = next;
  }
  return nearest.child;
}

/// Ordered traversal of one ray: the nearest child goes on, the others wait in the order of their distance, and what waits is
/// dropped once a nearer hit is known. An any hit takes the slots by descending area.
template <class Node, bool any, class Counter>
HWY_INLINE Hit trace_one(const Tree& tree, const Ray& input, Pending* const stack, Counter& counter) {
  constexpr std::size_t W = Node::width;
  using D = FloatsOf<Node::width>;
  const D d;
  const FloatsOf<8> d_leaf;
  const WideRay ray(input, tree.slabs);
  if (!ray.valid) return {};
  const SlabVectors<D> slabs(d, ray);
  const ShearVectors<FloatsOf<8>> shear(d_leaf, ray);
  const auto* const nodes = static_cast<const Node*>(tree.nodes);
  const auto tmin = hn::Set(d, ray.scaled(input.tmin));
  Hit hit;
  hit.t = input.tmax;
  float farthest = ray.scaled(hit.t);
  auto tmax = hn::Set(d, farthest);
  Pending* top = stack;
  std::uint32_t child = 0;
  while (true) {
    if (!WideChild::is_leaf(child)) {
      const Node& node = nodes[child];
      counter.inner();
      counter.boxes(W);
      HWY_ALIGN std::array<float, W> near;
      unsigned met = 0;
      for (std::size_t lane = 0; lane < W; lane += hn::MaxLanes(d)) {
        const Slabs<D> boxes = test_boxes(d, node, lane, slabs, tmin, tmax);
        if constexpr (!any) hn::Store(boxes.enter, d, near.data() + lane);
        met |= mask_bits(boxes.met()) << lane;
      }
      if (met != 0) {
        child = any ? push_by_slot(node, met, top) : push_by_distance(node, met, near, top);
        continue;
      }
    } else {
      counter.leaf();
      counter.triangles(WideChild::count(child));
      if (test_leaf<any>(d_leaf, tree, child, ray, shear, input.tmin, hit)) {
        if constexpr (any) return hit;
        farthest = ray.scaled(hit.t);
        tmax = hn::Set(d, farthest);
      }
    }
    do {
      if (top == stack) return hit.is_hit() ? hit : Hit{};
      --top;
    } while (!any && top->near > farthest);
    child = top->child;
  }
}

template <class Node, class Counter, class Write>
HWY_INLINE void trace_rays(const Tree& tree, std::span<const Ray> rays, Query query, Counter& counter, Write&& write) {
  std::vector<Pending> stack(stack_room(tree, Node::width));
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit hit = query == Query::any_hit ? trace_one<Node, true>(tree, rays[i], stack.data(), counter)
                                            : trace_one<Node, false>(tree, rays[i], stack.data(), counter);
    write(i, hit);
  }
}

}  // namespace raystudy::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
