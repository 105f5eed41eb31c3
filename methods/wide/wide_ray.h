#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "harness/geometry/box.h"
#include "harness/geometry/ray.h"

namespace raystudy::wide {

/// What all rays of a session have in common.
struct SlabScene {
  Box bounds;         ///< holds every box and triangle that will be tested
  float reach = 0;    ///< the largest coordinate in `bounds`, by magnitude
  bool huge = false;  ///< past 2^80, where what replaces a tiny component of the direction would move the ray: no box is culled

  static constexpr float largest = 0x1p80F;

  SlabScene() = default;
  explicit SlabScene(const Box& b) : bounds(b) {
    for (int i = 0; i < 3; ++i) reach = max(reach, max(std::fabs(b.lower[i]), std::fabs(b.upper[i])));
    huge = !(reach < largest);
  }
};

/// A ray made ready for tests of many boxes by one fused multiply-add a plane: t = plane · reciprocal - offset. No box is missed
/// that holds a triangle which the watertight test (harness/geometry/watertight.h) accepts.
///
/// All that rounds is moved to the safe side once per ray, as a displacement of the origin along each axis (compare SlabRay in
/// harness/geometry/slab.h, where Woop's and Ize's bounds come from). With u = 2⁻²⁴, |plane - origin| ≤ reach_i, |plane| and
/// |origin| ≤ reach_i + |origin|:
///   6 u (reach_i + farthest)         the displacement of sheared corners (Woop, Benthin, Wald 2013, Sec. 4) and t's own rounding
///   2 u reach_i                      the reciprocal's rounding and the last rounding of t
///   6 u (|origin| + reach_i)         the offset's two roundings and, without fused instructions, that of the product
/// A component of the direction that is 0 or tiny is replaced by one so small that it moves the ray, within the scene, by less
/// than the displacement; so every reciprocal is finite and no product is NaN.
struct WideRay {
  std::array<float, 4> reciprocal{};
  std::array<float, 4> near_offset{};
  std::array<float, 4> far_offset{};
  std::array<std::uint32_t, 3> near_plane{};  ///< per axis: 0 where lower planes are entered first, else 1
  float scale = 1;                            ///< t of the boxes over t of the ray; a power of two
  bool valid = false;  ///< finite, a direction that is not zero, 0 <= tmin <= tmax; a ray that is not valid hits nothing

  // The watertight test's part: see ShearedRay in harness/geometry/watertight.h.
  int across = 0, up = 1, along = 2;
  std::array<float, 3> origin{};  ///< along `across`, `up` and `along`
  float shear_across = 0, shear_up = 0;
  float direction_along = 1;

  WideRay(const Ray& ray, const SlabScene& scene) {
    const Vec3 o = ray.origin;
    Vec3 d = ray.direction;
    const Vec3 size{std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
    along = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    across = along == 2 ? 0 : along + 1;
    up = across == 2 ? 0 : across + 1;
    const float longest = size[along];
    valid = is_finite(o) && is_finite(d) && longest > 0 && ray.tmin >= 0 && ray.tmin <= ray.tmax;
    if (!valid) return;
    direction_along = d[along];
    shear_across = d[across] / direction_along;
    shear_up = d[up] / direction_along;
    origin = {o[across], o[up], o[along]};
    if (!(longest > 0x1p-20F && longest < 0x1p20F)) rescale(d, longest);
    set_slabs(o, d, scene);
  }

  /// t of the ray → t of the boxes.
  [[nodiscard]] float scaled(float t) const { return t * scale; }

 private:
  void rescale(Vec3& d, float longest) {
    const int exponent = std::ilogb(longest);
    for (int i = 0; i < 3; ++i) d[i] = std::ldexp(d[i], -exponent);
    scale = std::ldexp(1.0F, exponent);
  }

  void set_slabs(Vec3 o, Vec3 d, const SlabScene& scene) {
    constexpr float u = 0x1p-24F;
    Vec3 reach;
    for (int i = 0; i < 3; ++i) reach[i] = max(std::fabs(scene.bounds.lower[i] - o[i]), std::fabs(scene.bounds.upper[i] - o[i]));
    const float farthest = max(max(reach.x, reach.y), reach.z);
    const float coordinates = max(scene.reach, max(max(std::fabs(o.x), std::fabs(o.y)), std::fabs(o.z)));
    const bool unbounded = scene.huge || !(coordinates < SlabScene::largest);
    const float least = max(coordinates * 0x1p-124F, 0x1p-100F);
    for (int i = 0; i < 3; ++i) {
      const auto a = static_cast<std::size_t>(i);
      const float error = u * (14 * reach[i] + 6 * farthest + 6 * std::fabs(o[i])) + std::numeric_limits<float>::min();
      const float component = std::copysign(max(std::fabs(d[i]), least), d[i]);
      const float inverse = 1 / component;
      const float displacement = std::copysign(error, component);
      near_plane[a] = std::signbit(component) ? 1 : 0;
      // Unbounded: from one end of the floats to the other, but not for an empty slot, whose planes are infinite.
      constexpr float end = std::numeric_limits<float>::max();
      reciprocal[a] = unbounded ? std::copysign(std::numeric_limits<float>::min(), component) : inverse;
      near_offset[a] = unbounded ? end : (o[i] + displacement) * inverse;
      far_offset[a] = unbounded ? -end : (o[i] - displacement) * inverse;
    }
  }
};

}  // namespace raystudy::wide
