// Rays side by side, one a lane. Compiled once for each instruction set (Highway's foreach_target): no include guard in the usual
// sense.

#if defined(RAYSTUDY_PACKETS_RAY_GROUP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_PACKETS_RAY_GROUP_INL_H_
#undef RAYSTUDY_PACKETS_RAY_GROUP_INL_H_
#else
#define RAYSTUDY_PACKETS_RAY_GROUP_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "harness/geometry/ray.h"
#include "methods/wide/wide_ray.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Lanes of a vector over `n` things: n, or as many as the instruction set has.
template <int n>
using FloatsOf = hn::CappedTag<float, n>;

template <class D>
inline constexpr std::size_t lanes_of = hn::MaxLanes(D());

/// As wide as StoreMaskBits writes: a longer word would have to wait until all that is written is in the cache.
template <class D>
using MaskWord = std::conditional_t<(lanes_of<D> > 8), std::uint16_t, std::uint8_t>;

template <class D>
HWY_INLINE unsigned mask_bits(D d, hn::Mask<D> mask) {
  MaskWord<D> bits = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

template <class D>
HWY_INLINE hn::Mask<D> mask_of(D d, unsigned bits) {
  const auto word = static_cast<MaskWord<D>>(bits);
  return hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(&word));
}

/// Rays of one octant made ready for the tests of boxes and triangles as WideRay is, bit for bit, and the nearest hits they have
/// found so far.
template <class D>
struct alignas(64) RayGroup {
  static constexpr std::size_t lanes = lanes_of<D>;
  using Row = std::array<float, lanes>;

  std::array<Row, 3> reciprocal, near_offset, far_offset;
  Row near, far;  ///< limits of the boxes' t; near > far where no ray is left that may still hit
  std::array<Row, 3> origin;
  Row shear_across, shear_up, direction_along;
  Row scale, tmin;
  Row t;
  std::array<std::uint32_t, lanes> triangle;
  std::array<double, lanes> b, c, area;  ///< of the nearest triangle met: u = b / area, v = c / area
  std::array<unsigned, 3> along;         ///< lanes by the axis that their rays follow
  unsigned active;                       ///< lanes of rays that may still hit
};

/// The range of the slab constants of many rays of one octant.
template <class D>
struct SlabRanges {
  using V = hn::Vec<D>;
  std::array<V, 3> least_reciprocal, greatest_reciprocal;
  std::array<V, 3> near_origin, far_origin;  ///< displaced to the safe side; of all rays those for which slabs are widest
  V near, far;                               ///< least and greatest limit
  std::array<bool, 3> negative;
  bool bounded = true;  ///< false where a ray is not like the others, so that the ranges say nothing of it

  HWY_INLINE SlabRanges(D d, unsigned octant) {
    const V most = hn::Set(d, std::numeric_limits<float>::infinity());
    for (std::size_t a = 0; a < 3; ++a) {
      negative[a] = ((octant >> a) & 1U) != 0;
      least_reciprocal[a] = most;
      greatest_reciprocal[a] = hn::Neg(most);
      near_origin[a] = negative[a] ? most : hn::Neg(most);
      far_origin[a] = hn::Neg(near_origin[a]);
    }
    near = most;
    far = hn::Neg(most);
  }

  HWY_INLINE void take(std::size_t a, hn::Mask<D> valid, V reciprocal, V displaced_near, V displaced_far) {
    const auto least = [valid](V& of, V with) { of = hn::IfThenElse(valid, hn::Min(of, with), of); };
    const auto greatest = [valid](V& of, V with) { of = hn::IfThenElse(valid, hn::Max(of, with), of); };
    least(least_reciprocal[a], reciprocal);
    greatest(greatest_reciprocal[a], reciprocal);
    if (negative[a]) {
      least(near_origin[a], displaced_near);
      greatest(far_origin[a], displaced_far);
    } else {
      greatest(near_origin[a], displaced_near);
      least(far_origin[a], displaced_far);
    }
  }
};

/// The components of as many rays.
template <class D>
struct RayRows {
  using V = hn::Vec<D>;
  std::array<V, 3> origin, direction;
  V tmin, tmax;

  HWY_INLINE RayRows(D d, const Ray* rays) {
    const auto* floats = reinterpret_cast<const float*>(rays);
    // Of each half of the rays: {x, y, z, t} of the origin and of the direction in turn.
    std::array<V, 4> a;
    std::array<V, 4> b;
    hn::LoadInterleaved4(d, floats, a[0], a[1], a[2], a[3]);
    hn::LoadInterleaved4(d, floats + 4 * lanes_of<D>, b[0], b[1], b[2], b[3]);
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = hn::ConcatEven(d, b[i], a[i]);
      direction[i] = hn::ConcatOdd(d, b[i], a[i]);
    }
    tmin = hn::ConcatEven(d, b[3], a[3]);
    tmax = hn::ConcatOdd(d, b[3], a[3]);
  }

  /// Tells which rays are valid (see WideRay), and puts a harmless origin and direction in the place of the others'.
  HWY_INLINE hn::Mask<D> sort_out(D d) {
    const V zero = hn::Zero(d);
    V sum = zero;  // stays 0 until something is not finite
    V longest = zero;
    for (std::size_t i = 0; i < 3; ++i) {
      sum = hn::Add(sum, hn::Add(hn::Mul(origin[i], zero), hn::Mul(direction[i], zero)));
      longest = hn::Max(longest, hn::Abs(direction[i]));
    }
    const auto finite = hn::And(hn::Eq(sum, zero), hn::Gt(longest, zero));
    const auto valid = hn::And(finite, hn::And(hn::Ge(tmin, zero), hn::Le(tmin, tmax)));
    for (std::size_t i = 0; i < 3; ++i) {
      origin[i] = hn::IfThenElseZero(valid, origin[i]);
      direction[i] = hn::IfThenElse(valid, direction[i], hn::Set(d, 1));
    }
    return valid;
  }
};

/// The watertight test's part.
template <class D>
HWY_INLINE void set_shear(D d, const RayRows<D>& rays, RayGroup<D>& group) {
  const auto& direction = rays.direction;
  const auto x = hn::Abs(direction[0]);
  const auto y = hn::Abs(direction[1]);
  const auto z = hn::Abs(direction[2]);
  const auto x_over_y = hn::Gt(x, y);
  const auto along_x = hn::And(x_over_y, hn::Gt(x, z));
  const auto along_y = hn::AndNot(x_over_y, hn::Gt(y, z));
  const auto choose = [&](std::size_t of_x, std::size_t of_y, std::size_t of_z) {
    return hn::IfThenElse(along_x, direction[of_x], hn::IfThenElse(along_y, direction[of_y], direction[of_z]));
  };
  const auto along = choose(0, 1, 2);
  hn::Store(along, d, group.direction_along.data());
  hn::Store(hn::Div(choose(1, 2, 0), along), d, group.shear_across.data());
  hn::Store(hn::Div(choose(2, 0, 1), along), d, group.shear_up.data());
  for (std::size_t a = 0; a < 3; ++a) hn::Store(rays.origin[a], d, group.origin[a].data());
  group.along[0] = mask_bits(d, along_x);
  group.along[1] = mask_bits(d, along_y);
  group.along[2] = ((1U << lanes_of<D>)-1U) & ~(group.along[0] | group.along[1]);
}

/// The slabs' part, by the formulas of WideRay::set_slabs; gives the lanes that need WideRay itself.
template <class D>
HWY_INLINE hn::Mask<D> set_slabs(D d, const RayRows<D>& rays, hn::Mask<D> valid, const wide::SlabScene& scene, RayGroup<D>& group,
                                 SlabRanges<D>& ranges) {
  using V = hn::Vec<D>;
  std::array<V, 3> reach;
  V coordinates = hn::Set(d, scene.reach);
  V longest = hn::Zero(d);
  for (std::size_t a = 0; a < 3; ++a) {
    reach[a] = hn::Max(hn::Abs(hn::Sub(hn::Set(d, scene.lower[a]), rays.origin[a])),
                       hn::Abs(hn::Sub(hn::Set(d, scene.upper[a]), rays.origin[a])));
    coordinates = hn::Max(coordinates, hn::Abs(rays.origin[a]));
    longest = hn::Max(longest, hn::Abs(rays.direction[a]));
  }
  const V farthest = hn::Max(hn::Max(reach[0], reach[1]), reach[2]);
  const V least = hn::Max(hn::Mul(coordinates, hn::Set(d, 0x1p-124F)), hn::Set(d, 0x1p-100F));
  for (std::size_t a = 0; a < 3; ++a) {
    const V o = rays.origin[a];
    const V relative =
        hn::Add(hn::Add(hn::Mul(hn::Set(d, 14), reach[a]), hn::Mul(hn::Set(d, 6), farthest)), hn::Mul(hn::Set(d, 6), hn::Abs(o)));
    const V error = hn::Add(hn::Mul(hn::Set(d, 0x1p-24F), relative), hn::Set(d, std::numeric_limits<float>::min()));
    const V component = hn::CopySign(hn::Max(hn::Abs(rays.direction[a]), least), rays.direction[a]);
    const V inverse = hn::Div(hn::Set(d, 1), component);
    const V displacement = hn::CopySign(error, component);
    const V near_origin = hn::Add(o, displacement);
    const V far_origin = hn::Sub(o, displacement);
    hn::Store(inverse, d, group.reciprocal[a].data());
    hn::Store(hn::Mul(near_origin, inverse), d, group.near_offset[a].data());
    hn::Store(hn::Mul(far_origin, inverse), d, group.far_offset[a].data());
    ranges.take(a, valid, inverse, near_origin, far_origin);
  }
  const auto plain = hn::And(hn::And(hn::Gt(longest, hn::Set(d, 0x1p-20F)), hn::Lt(longest, hn::Set(d, 0x1p20F))),
                             hn::Lt(coordinates, hn::Set(d, wide::SlabScene::largest)));
  return hn::AndNot(plain, valid);
}

/// A direction of extreme length is rescaled, and coordinates past SlabScene::largest have slabs of their own: see WideRay.
template <class D>
HWY_NOINLINE void set_slabs_by_wide_ray(const Ray& ray, std::size_t lane, const wide::SlabScene& scene, RayGroup<D>& group) {
  const wide::WideRay one(ray, scene);
  for (std::size_t a = 0; a < 3; ++a) {
    group.reciprocal[a][lane] = one.reciprocal[a];
    group.near_offset[a][lane] = one.near_offset[a];
    group.far_offset[a][lane] = one.far_offset[a];
  }
  group.scale[lane] = one.scale;
  group.near[lane] = one.scaled(ray.tmin);
  group.far[lane] = one.scaled(ray.tmax);
}

/// Makes lanes_of<D> rays ready. Those that are valid have all the octant of `ranges`.
template <class D>
HWY_INLINE void make_ready(D d, const Ray* input, const wide::SlabScene& scene, RayGroup<D>& group, SlabRanges<D>& ranges) {
  using V = hn::Vec<D>;
  const hn::Rebind<std::uint32_t, D> du;
  RayRows<D> rays(d, input);
  const auto valid = rays.sort_out(d);
  const V infinity = hn::Set(d, std::numeric_limits<float>::infinity());
  const V near = hn::IfThenElse(valid, rays.tmin, infinity);
  const V far = hn::IfThenElse(valid, rays.tmax, hn::Neg(infinity));
  hn::Store(near, d, group.near.data());
  hn::Store(far, d, group.far.data());
  hn::Store(hn::Set(d, 1), d, group.scale.data());
  hn::Store(rays.tmin, d, group.tmin.data());
  hn::Store(rays.tmax, d, group.t.data());
  hn::Store(hn::Set(du, no_hit), du, group.triangle.data());
  ranges.near = hn::Min(ranges.near, near);
  ranges.far = hn::Max(ranges.far, far);
  group.active = mask_bits(d, valid);
  set_shear(d, rays, group);
  unsigned unlike = mask_bits(d, set_slabs(d, rays, valid, scene, group, ranges));
  if (unlike == 0) return;
  ranges.bounded = false;
  for (; unlike != 0; unlike &= unlike - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(unlike));
    set_slabs_by_wide_ray(input[lane], lane, scene, group);
  }
}

/// A weight of each ray's nearest triangle met, over its area.
template <class D>
HWY_INLINE hn::Vec<D> weight_of(D d, const std::array<double, lanes_of<D>>& weight, const RayGroup<D>& group) {
  const hn::Half<D> dh;
  const hn::Rebind<double, hn::Half<D>> dd;
  const auto half = [&](std::size_t begin) {
    return hn::DemoteTo(dh, hn::Div(hn::Load(dd, weight.data() + begin), hn::Load(dd, group.area.data() + begin)));
  };
  return hn::Combine(d, half(lanes_of<hn::Half<D>>), half(0));
}

/// Writes the hits of the first `count` lanes; of any hits u and v are not known and come as 0.
template <bool any, class D>
HWY_INLINE void write_hits(D d, const RayGroup<D>& group, std::size_t count, Hit* out) {
  const hn::Rebind<std::uint32_t, D> du;
  const auto triangle = hn::Load(du, group.triangle.data());
  const auto none = hn::RebindMask(d, hn::Eq(triangle, hn::Set(du, no_hit)));
  const auto t = hn::IfThenElse(none, hn::Set(d, std::numeric_limits<float>::infinity()), hn::Load(d, group.t.data()));
  auto u = hn::Zero(d);
  auto v = hn::Zero(d);
  if constexpr (!any) {
    u = hn::IfThenZeroElse(none, weight_of(d, group.b, group));
    v = hn::IfThenZeroElse(none, weight_of(d, group.c, group));
  }
  if (count >= lanes_of<D>) {
    hn::StoreInterleaved4(t, hn::BitCast(d, triangle), u, v, d, reinterpret_cast<float*>(out));
    return;
  }
  std::array<Hit, lanes_of<D>> hits;
  hn::StoreInterleaved4(t, hn::BitCast(d, triangle), u, v, d, reinterpret_cast<float*>(hits.data()));
  for (std::size_t i = 0; i < count; ++i) out[i] = hits[i];
}

}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
