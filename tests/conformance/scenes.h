#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/geometry/ray.h"
#include "harness/scene/scene.h"

namespace raystudy::test {

/// A scene that every method must cope with.
struct ConformanceScene {
  std::string name;
  Scene scene;
  bool within_embree_range = true;  ///< Embree flushes denormals to zero, and its products of lengths overflow
};

/// Every procedural scene at its smallest, and all the ways in which triangles can be degenerate, few, equal, huge or tiny.
[[nodiscard]] const std::vector<ConformanceScene>& conformance_scenes();

/// Rays through the scene's box and past it, along axes and within faces of the box, and at corners and edges of triangles.
[[nodiscard]] std::vector<Ray> conformance_rays(const Scene& scene);

}  // namespace raystudy::test
