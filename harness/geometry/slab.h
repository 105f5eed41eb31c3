#pragma once

#include <immintrin.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "harness/geometry/box.h"
#include "harness/geometry/ray.h"

namespace raystudy {

/// Two boxes side by side, axis by axis: axis[i] = {lower of box 0, lower of box 1, upper of box 0, upper of box 1}.
struct alignas(16) SlabPair {
  std::array<std::array<float, 4>, 3> axis;

  SlabPair() = default;
  SlabPair(const Box& a, const Box& b)
      : axis{{{a.lower.x, b.lower.x, a.upper.x, b.upper.x},
              {a.lower.y, b.lower.y, a.upper.y, b.upper.y},
              {a.lower.z, b.lower.z, a.upper.z, b.upper.z}}} {}
};
static_assert(sizeof(SlabPair) == 48);

/// What a slab test found: bit i of `mask` tells that box i was met, near[i] where it is entered (a lower bound, in the ray's
/// scaled t: good for ordering and for comparing with `SlabRay::scaled`).
struct SlabHit {
  unsigned mask;
  alignas(16) std::array<float, 4> near;
};

/// A ray made ready for slab tests that never miss a box which holds a triangle that `intersect` (watertight.h) accepts.
///
/// What rounds is moved to the safe side once per ray, so that a test costs no more than a plain one: the reciprocals by 2 ulp
/// (Ize, "Robust BVH Ray Traversal", JCGT 2(2), 2013: one for the division, one for the difference, while the last product rounds
/// monotonically), and the origin by the error of sheared corners, 5 · 2⁻²⁴ of the largest distances within `bounds` (Woop,
/// Benthin, Wald 2013, section 4). A direction component of 0 (of either sign) has infinite reciprocals: the ray is inside the
/// slab or not, and 0 · ∞ = NaN, a ray in a face, counts as inside. A ray with tmin < 0 is outside the contract.
struct SlabRay {
  __m128 origin[3];          ///< per axis: {near, near, far, far}
  __m128 reciprocal[3];      ///< per axis: {near, near, -far, -far}
  std::size_t near_half[3];  ///< per axis: 0 where lower planes are entered first, else 2
  float scale = 1;           ///< t of the scaled ray over t of the ray; a power of two

  /// `bounds` holds every box and triangle that will be tested.
  SlabRay(const Ray& ray, const Box& bounds) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    constexpr float largest_float = std::numeric_limits<float>::max();
    constexpr float epsilon = 6.0F / 16777216.0F;  // Woop's 5 · 2⁻²⁴, and one for the rounding of this sum itself
    Vec3 direction = ray.direction;
    const float longest = max(max(std::fabs(direction.x), std::fabs(direction.y)), std::fabs(direction.z));
    if (!(longest > 0x1p-60F && longest < 0x1p60F)) rescale(direction, longest);
    Vec3 reach;
    for (int i = 0; i < 3; ++i) {
      reach[i] = max(std::fabs(bounds.lower[i] - ray.origin[i]), std::fabs(bounds.upper[i] - ray.origin[i]));
    }
    const float farthest = max(max(reach.x, reach.y), reach.z);
    for (int i = 0; i < 3; ++i) {
      const float d = direction[i];
      // The last term covers what underflows and stays clear of denormals, the one before it the rounding of origin ± error.
      const float error =
          epsilon * (reach[i] + farthest) + std::fabs(ray.origin[i]) * 0x1p-23F + std::numeric_limits<float>::min();
      const float inverse = 1 / d;
      const bool negative = std::signbit(d);
      const float origin_near = negative ? ray.origin[i] - error : ray.origin[i] + error;
      const float origin_far = negative ? ray.origin[i] + error : ray.origin[i] - error;
      float near_inverse = inverse * (1 - 0x1p-22F);
      // The reciprocal of a tiny component overflows: entering must not come out later than it is.
      if (d != 0 && std::fabs(inverse) == infinity) near_inverse = std::copysign(largest_float, inverse);
      const float far_inverse = inverse * (1 + 0x1p-22F);
      origin[i] = _mm_setr_ps(origin_near, origin_near, origin_far, origin_far);
      reciprocal[i] = _mm_setr_ps(near_inverse, near_inverse, -far_inverse, -far_inverse);
      near_half[i] = negative ? 2 : 0;
    }
  }

  /// t of the ray → t of the scaled ray, in which boxes are entered and left.
  [[nodiscard]] float scaled(float t) const { return t * scale; }
  /// The limits of a test: {tmin, tmin, -tmax, -tmax}, from t of the ray.
  [[nodiscard]] __m128 limits(float tmin, float tmax) const {
    return _mm_setr_ps(scaled(tmin), scaled(tmin), -scaled(tmax), -scaled(tmax));
  }

 private:
  /// Brings a direction of extreme length near 1 by a power of two, so that no reciprocal is denormal or overflows.
  void rescale(Vec3& direction, float longest) {
    if (!(longest > 0 && longest < std::numeric_limits<float>::infinity())) return;
    const int exponent = std::ilogb(longest);
    for (int i = 0; i < 3; ++i) direction[i] = std::ldexp(direction[i], -exponent);
    scale = std::ldexp(1.0F, exponent);
  }
};

/// Tests both boxes of a pair against the part of the ray within `limits` (SlabRay::limits).
inline SlabHit test_boxes(const SlabRay& ray, const SlabPair& pair, __m128 limits) {
  __m128 t = limits;
  for (std::size_t i = 0; i < 3; ++i) {
    // {near, near, far, far}; two halves of one row, so that no lane must be exchanged by the ray's sign.
    const float* row = pair.axis[i].data();
    const __m128 near = _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(row + ray.near_half[i])));
    const __m128 planes = _mm_loadh_pi(near, reinterpret_cast<const __m64*>(row + (2 - ray.near_half[i])));
    // maxps gives its second operand where one is NaN, so a slab the ray lies in does not narrow anything.
    t = _mm_max_ps(_mm_mul_ps(_mm_sub_ps(planes, ray.origin[i]), ray.reciprocal[i]), t);
  }
  // Far ends are negated to share the maximum.
  const __m128 far = _mm_xor_ps(_mm_movehl_ps(t, t), _mm_set1_ps(-0.0F));
  SlabHit hit;
  hit.mask = static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(t, far))) & 3U;
  _mm_store_ps(hit.near.data(), t);
  return hit;
}

}  // namespace raystudy
