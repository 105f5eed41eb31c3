#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "harness/geometry/vec3.h"

namespace raystudy {

/// A ray segment: origin + t · direction for t in [tmin, tmax]. The direction need not have unit length;
/// 0 <= tmin <= tmax. A ray that breaks this, is not finite, or has no direction hits nothing.
struct Ray {
  Vec3 origin;
  float tmin = 0;
  Vec3 direction;
  float tmax = std::numeric_limits<float>::infinity();
};
static_assert(sizeof(Ray) == 32);

inline constexpr std::uint32_t no_hit = 0xffffffffU;

/// What a ray met. `triangle` indexes Scene::triangles; u and v weigh its second and third vertex.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = no_hit;
  float u = 0;
  float v = 0;

  [[nodiscard]] bool is_hit() const { return triangle != no_hit; }
};
static_assert(sizeof(Hit) == 16);

/// closest_hit: the nearest triangle. any_hit: some triangle or none (`triangle != no_hit` says which; t, u, v are unspecified).
enum class Query : std::uint8_t { closest_hit, any_hit };

constexpr std::string_view query_name(Query q) { return q == Query::closest_hit ? "closest-hit" : "any-hit"; }

}  // namespace raystudy
