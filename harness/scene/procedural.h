#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/scene.h"

namespace raystudy {

/// A built-in scene that scales: its name and what it is for, in one line.
struct ProceduralInfo {
  std::string name;
  std::string summary;
};
[[nodiscard]] const std::vector<ProceduralInfo>& procedural_scenes();

/// Makes the scene with about `triangles` triangles (within 5 %; 10³ to 10⁸), the same for a seed on every machine, with two named
/// cameras and a light. Holds nothing but the result in memory. Throws Error for an unknown name or a count out of range.
[[nodiscard]] Scene make_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed);

}  // namespace raystudy
