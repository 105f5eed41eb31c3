// The triangles of a leaf against rays side by side. Compiled once for each instruction set: no include guard in the usual sense.

#if defined(RAYSTUDY_PACKETS_LEAF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_PACKETS_LEAF_INL_H_
#undef RAYSTUDY_PACKETS_LEAF_INL_H_
#else
#define RAYSTUDY_PACKETS_LEAF_INL_H_
#endif

#include "methods/packets/ray_group-inl.h"
#include "methods/wide/kernels.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {

/// A triangle's corners, sheared for each ray.
template <class D>
struct ShearedCorners {
  std::array<hn::Vec<D>, 3> x, y, z;
};

/// Where half of a group's rays meet a triangle: t is NaN where they do not. u and v are b / area and c / area: two divisions
/// that are put off until a ray's last hit is known.
template <class DH>
struct HalfMeetings {
  hn::Vec<DH> t;
  hn::Vec<hn::Rebind<double, DH>> b, c, area;
};

/// finish_test of harness/geometry/watertight.h, with the same roundings, in all lanes but for the limits of t.
template <class DH>
HWY_INLINE HalfMeetings<DH> finish_half(DH dh, const ShearedCorners<DH>& corners, hn::Vec<DH> direction_along) {
  const hn::Rebind<double, DH> dd;
  const auto wide = [&](hn::Vec<DH> v) { return hn::PromoteTo(dd, v); };
  const auto edge = [&](std::size_t i, std::size_t j) {
    return hn::Sub(hn::Mul(wide(corners.x[j]), wide(corners.y[i])), hn::Mul(wide(corners.y[j]), wide(corners.x[i])));
  };
  const auto a = edge(1, 2);
  const auto b = edge(2, 0);
  const auto c = edge(0, 1);
  const auto zero = hn::Zero(dd);
  const auto negative = hn::Or(hn::Or(hn::Lt(a, zero), hn::Lt(b, zero)), hn::Lt(c, zero));
  const auto positive = hn::Or(hn::Or(hn::Gt(a, zero), hn::Gt(b, zero)), hn::Gt(c, zero));
  const auto area = hn::Add(hn::Add(a, b), c);
  const auto missed = hn::Or(hn::And(negative, positive), hn::Eq(area, zero));
  const auto moment =
      hn::Add(hn::Add(hn::Mul(a, wide(corners.z[0])), hn::Mul(b, wide(corners.z[1]))), hn::Mul(c, wide(corners.z[2])));
  const auto t = hn::Div(moment, hn::Mul(area, wide(direction_along)));
  const auto nan = hn::Set(dd, std::numeric_limits<double>::quiet_NaN());
  return {hn::DemoteTo(dh, hn::IfThenElse(missed, nan, t)), b, c, area};
}

template <class D, class Half>
HWY_INLINE ShearedCorners<hn::Half<D>> half_of(const ShearedCorners<D>& corners, const Half& half) {
  ShearedCorners<hn::Half<D>> out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.x[i] = half(corners.x[i]);
    out.y[i] = half(corners.y[i]);
    out.z[i] = half(corners.z[i]);
  }
  return out;
}

/// Takes a triangle into the hits of those `candidates` (lanes) that it is the nearest one for; gives these lanes.
template <bool any, class D>
HWY_INLINE unsigned take_nearest(D d, const ShearedCorners<D>& corners, std::uint32_t triangle, unsigned candidates,
                                 RayGroup<D>& group) {
  const hn::Rebind<std::uint32_t, D> du;
  const hn::Half<D> dh;
  const hn::Rebind<double, hn::Half<D>> dd;
  const auto direction_along = hn::Load(d, group.direction_along.data());
  const auto lower = [&](hn::Vec<D> v) { return hn::LowerHalf(dh, v); };
  const auto upper = [&](hn::Vec<D> v) { return hn::UpperHalf(dh, v); };
  const auto low = finish_half(dh, half_of(corners, lower), lower(direction_along));
  const auto high = finish_half(dh, half_of(corners, upper), upper(direction_along));
  const auto t = hn::Combine(d, high.t, low.t);
  const auto before = hn::Load(d, group.t.data());
  const auto others = hn::Load(du, group.triangle.data());
  const auto ids = hn::Set(du, triangle);
  const auto within = hn::And(hn::And(hn::Ge(t, hn::Load(d, group.tmin.data())), hn::Le(t, before)),
                              hn::Lt(t, hn::Set(d, std::numeric_limits<float>::infinity())));
  // Of equal distances the lowest triangle is the hit.
  const auto loses = hn::And(hn::Eq(t, before), hn::RebindMask(d, hn::Lt(others, ids)));
  const auto taken = hn::And(mask_of(d, candidates), hn::AndNot(loses, within));
  const unsigned bits = mask_bits(d, taken);
  hn::Store(hn::IfThenElse(taken, t, before), d, group.t.data());
  hn::Store(hn::IfThenElse(hn::RebindMask(du, taken), ids, others), du, group.triangle.data());
  if constexpr (!any) {
    const auto store = [&](const HalfMeetings<hn::Half<D>>& half, unsigned lanes, std::size_t begin) {
      const auto mask = mask_of(dd, lanes);
      hn::BlendedStore(half.b, mask, dd, group.b.data() + begin);
      hn::BlendedStore(half.c, mask, dd, group.c.data() + begin);
      hn::BlendedStore(half.area, mask, dd, group.area.data() + begin);
    };
    store(low, bits, 0);
    store(high, bits >> lanes_of<hn::Half<D>>, lanes_of<hn::Half<D>>);
  }
  return bits;
}

/// Tests a leaf's triangles against those `rays` (lanes) of a group that all follow axis `along`. Gives the lanes that found a
/// nearer hit; of any hits each ray takes the first.
template <bool any, class D>
HWY_INLINE unsigned test_leaf_along(D d, const wide::Tree& tree, std::uint32_t child, unsigned rays, std::size_t along,
                                    RayGroup<D>& group) {
  const std::uint32_t n = WideChild::count(child);
  const std::uint32_t first = WideChild::first(child);
  const float* const rows = tree.corners + std::size_t{9} * first;
  const std::size_t across = along == 2 ? 0 : along + 1;
  const std::size_t up = across == 2 ? 0 : across + 1;
  const auto ox = hn::Load(d, group.origin[across].data());
  const auto oy = hn::Load(d, group.origin[up].data());
  const auto oz = hn::Load(d, group.origin[along].data());
  const auto sx = hn::Load(d, group.shear_across.data());
  const auto sy = hn::Load(d, group.shear_up.data());
  const auto zero = hn::Zero(d);
  const std::size_t stride = n;
  unsigned nearer = 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    ShearedCorners<D> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto at = [&](std::size_t axis) { return hn::Set(d, rows[stride * (3 * axis + c) + i]); };
      corners.z[c] = hn::Sub(at(along), oz);
      corners.x[c] = hn::Sub(hn::Sub(at(across), ox), hn::Mul(sx, corners.z[c]));
      corners.y[c] = hn::Sub(hn::Sub(at(up), oy), hn::Mul(sy, corners.z[c]));
    }
    const auto edge = [&](std::size_t p, std::size_t q) {
      return hn::Sub(hn::Mul(corners.x[q], corners.y[p]), hn::Mul(corners.y[q], corners.x[p]));
    };
    const auto u = edge(1, 2);
    const auto v = edge(2, 0);
    const auto w = edge(0, 1);
    const auto negative = hn::Lt(hn::Min(hn::Min(u, v), w), zero);
    const auto positive = hn::Gt(hn::Max(hn::Max(u, v), w), zero);
    const unsigned candidates = rays & ~mask_bits(d, hn::And(negative, positive));
    if (candidates == 0) continue;
    const unsigned taken = take_nearest<any>(d, corners, tree.triangles[first + i], candidates, group);
    nearer |= taken;
    if constexpr (any) {
      rays &= ~taken;
      if (rays == 0) break;
    }
  }
  return nearer;
}

/// Tests a leaf's triangles against those `rays` (lanes) of a group, and updates the limits of the boxes' t. True where a nearer
/// hit was found.
template <bool any, class D>
HWY_INLINE bool test_leaf(D d, const wide::Tree& tree, std::uint32_t child, unsigned rays, RayGroup<D>& group) {
  unsigned nearer = 0;
  for (std::size_t along = 0; along < 3; ++along) {
    const unsigned some = rays & group.along[along];
    if (some != 0) nearer |= test_leaf_along<any>(d, tree, child, some, along, group);
  }
  if (nearer == 0) return false;
  auto far = hn::Mul(hn::Load(d, group.t.data()), hn::Load(d, group.scale.data()));
  if constexpr (any) {
    group.active &= ~nearer;
    far = hn::IfThenElse(mask_of(d, group.active), hn::Load(d, group.far.data()), hn::Set(d, -1));
  } else {
    far = hn::IfThenElse(mask_of(d, group.active), far, hn::Load(d, group.far.data()));
  }
  hn::Store(far, d, group.far.data());
  return true;
}

}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
