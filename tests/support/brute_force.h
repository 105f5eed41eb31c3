#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/geometry/watertight.h"
#include "harness/scene/scene.h"

namespace raystudy::test {

/// Closest hits by testing every triangle; of several at one distance the one of the lowest index.
inline void closest_hits(const Scene& scene, std::span<const Ray> rays, std::span<Hit> hits) {
  std::vector<PackedTriangle> packed;
  packed.reserve(scene.triangles.size());
  for (const Triangle& v : scene.triangles) packed.emplace_back(scene.vertices[v[0]], scene.vertices[v[1]], scene.vertices[v[2]]);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit best;
    const ShearedRay ray(rays[i]);
    for (std::uint32_t t = 0; ray.valid && t < packed.size(); ++t) {
      TriangleHit found;
      if (!intersect(ray, packed[t], std::min(best.t, rays[i].tmax), found)) continue;
      if (!best.is_hit() || found.t < best.t) best = {found.t, t, found.u, found.v};
    }
    hits[i] = best;
  }
}

inline std::vector<Hit> closest_hits(const Scene& scene, std::span<const Ray> rays) {
  std::vector<Hit> hits(rays.size());
  closest_hits(scene, rays, hits);
  return hits;
}

}  // namespace raystudy::test
