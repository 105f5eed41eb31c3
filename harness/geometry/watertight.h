#pragma once

#include <immintrin.h>

#include <array>
#include <cmath>
#include <limits>

#include "harness/geometry/ray.h"
#include "harness/geometry/vec3.h"

namespace raystudy {

/// The corners a, b, c of a triangle, coordinate by coordinate: row[axis] = {a, b, c, a}.
struct alignas(16) PackedTriangle {
  std::array<std::array<float, 4>, 3> row;

  PackedTriangle() = default;
  PackedTriangle(Vec3 a, Vec3 b, Vec3 c) : row{{{a.x, b.x, c.x, a.x}, {a.y, b.y, c.y, a.y}, {a.z, b.z, c.z, a.z}}} {}
};
static_assert(sizeof(PackedTriangle) == 48);

/// Where a ray meets a triangle; u and v weigh its second and third corner.
struct TriangleHit {
  float t = 0;
  float u = 0;
  float v = 0;
};

/// A ray made ready for the watertight test of Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013):
/// space is sheared so that the ray runs along its longest axis, and the triangle is tested in the plane across it.
///
/// Each corner is sheared alone and rounds the same in every triangle that shares it, and no rounding changes the sign of an edge
/// function (a difference of two products, each rounded monotonically; compiled with -ffp-contract=off). So a ray cannot pass
/// between two triangles that share an edge or a vertex by index or by equal positions.
///
/// Coordinates must stay below 1.7e38 in magnitude, so that differences are finite.
struct ShearedRay {
  __m128 origin[3];  ///< along `across`, `up` and `along`, each in all lanes
  __m128 shear_across, shear_up;
  int across, up, along;  ///< axes; `along` is the one with the direction's largest magnitude
  float tmin;
  double direction_along;
  bool valid;  ///< finite, a direction that is not zero, 0 <= tmin <= tmax; a ray that is not valid hits nothing

  explicit ShearedRay(const Ray& ray) {
    const Vec3 d = ray.direction;
    const Vec3 magnitude{std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
    along = magnitude.x > magnitude.y ? (magnitude.x > magnitude.z ? 0 : 2) : (magnitude.y > magnitude.z ? 1 : 2);
    across = along == 2 ? 0 : along + 1;
    up = across == 2 ? 0 : across + 1;
    // A quotient, not a product with a rounded (or, for a tiny direction, infinite) reciprocal.
    shear_across = _mm_set1_ps(d[across] / d[along]);
    shear_up = _mm_set1_ps(d[up] / d[along]);
    origin[0] = _mm_set1_ps(ray.origin[across]);
    origin[1] = _mm_set1_ps(ray.origin[up]);
    origin[2] = _mm_set1_ps(ray.origin[along]);
    tmin = ray.tmin;
    direction_along = d[along];
    valid = is_finite(ray.origin) && is_finite(d) && magnitude[along] > 0 && ray.tmin >= 0 && ray.tmin <= ray.tmax;
  }
};

/// The rest of the test, for the few triangles that the signs of the rounded edge functions do not rule out: decides the edges
/// that came out as 0 or NaN (the products of floats are exact in double) and finds t, u and v without cancellation. `x`, `y` and
/// `z` are the sheared corners, three at least.
inline bool finish_test(const float* x, const float* y, const float* z, float tmin, double direction_along, float tmax,
                        TriangleHit& hit) {
  const auto edge = [&](int i, int j) {
    return static_cast<double>(x[j]) * static_cast<double>(y[i]) - static_cast<double>(y[j]) * static_cast<double>(x[i]);
  };
  const double a = edge(1, 2);
  const double b = edge(2, 0);
  const double c = edge(0, 1);
  if ((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0)) return false;
  const double area = a + b + c;
  if (!(area != 0)) return false;  // seen edge-on, or of no area
  const double t = (a * static_cast<double>(z[0]) + b * static_cast<double>(z[1]) + c * static_cast<double>(z[2])) /
                   (area * direction_along);
  const auto rounded = static_cast<float>(t);
  if (!(rounded >= tmin && rounded <= tmax && rounded < std::numeric_limits<float>::infinity())) return false;
  hit = {rounded, static_cast<float>(b / area), static_cast<float>(c / area)};
  return true;
}

/// True where the ray meets the triangle, from either side, at a finite t in [tmin, tmax]; edges and corners belong to it. A
/// triangle seen edge-on or of no area is not met.
inline bool intersect(const ShearedRay& ray, const PackedTriangle& triangle, float tmax, TriangleHit& hit) {
  const __m128 z = _mm_sub_ps(_mm_load_ps(triangle.row[static_cast<std::size_t>(ray.along)].data()), ray.origin[2]);
  __m128 x = _mm_sub_ps(_mm_load_ps(triangle.row[static_cast<std::size_t>(ray.across)].data()), ray.origin[0]);
  __m128 y = _mm_sub_ps(_mm_load_ps(triangle.row[static_cast<std::size_t>(ray.up)].data()), ray.origin[1]);
  x = _mm_sub_ps(x, _mm_mul_ps(ray.shear_across, z));
  y = _mm_sub_ps(y, _mm_mul_ps(ray.shear_up, z));
  // Lanes: (c, a, b) and (b, c, a), so that lane 0 is the edge function opposite corner a, and so on.
  const __m128 x_previous = _mm_shuffle_ps(x, x, _MM_SHUFFLE(2, 1, 0, 2));
  const __m128 y_next = _mm_shuffle_ps(y, y, _MM_SHUFFLE(0, 0, 2, 1));
  const __m128 y_previous = _mm_shuffle_ps(y, y, _MM_SHUFFLE(2, 1, 0, 2));
  const __m128 x_next = _mm_shuffle_ps(x, x, _MM_SHUFFLE(0, 0, 2, 1));
  const __m128 edges = _mm_sub_ps(_mm_mul_ps(x_previous, y_next), _mm_mul_ps(y_previous, x_next));
  const __m128 zero = _mm_setzero_ps();
  const bool some_negative = (_mm_movemask_ps(_mm_cmplt_ps(edges, zero)) & 7) != 0;
  const bool some_positive = (_mm_movemask_ps(_mm_cmpgt_ps(edges, zero)) & 7) != 0;
  if (some_negative && some_positive) return false;
  alignas(16) std::array<float, 4> xs{};
  alignas(16) std::array<float, 4> ys{};
  alignas(16) std::array<float, 4> zs{};
  _mm_store_ps(xs.data(), x);
  _mm_store_ps(ys.data(), y);
  _mm_store_ps(zs.data(), z);
  return finish_test(xs.data(), ys.data(), zs.data(), ray.tmin, ray.direction_along, tmax, hit);
}

}  // namespace raystudy
