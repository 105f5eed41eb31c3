#pragma once

#include <cstdint>
#include <vector>

#include "harness/scene/scene.h"

namespace raystudy::procedural {

struct Surface {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};

/// A bust of about `triangles` triangles as a scanner sees it: one closed surface of even triangles, 0.68 m high, that stands on
/// the origin and looks along +z.
[[nodiscard]] Surface bust(std::int64_t triangles, std::uint64_t seed);

}  // namespace raystudy::procedural
