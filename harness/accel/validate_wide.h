#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/accel/wide_bvh.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// The findings of validate.h for a wide tree over so many triangles; those that need the scene only where there is one.
[[nodiscard]] std::vector<std::string> wide_problems(const WideBvh& bvh, std::size_t triangles, const Scene* scene,
                                                     std::size_t most);

}  // namespace raystudy
