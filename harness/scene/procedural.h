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

inline constexpr std::int64_t procedural_triangles_min = 1'000;
inline constexpr std::int64_t procedural_triangles_max = 100'000'000;

/// Makes the scene with about `triangles` triangles (within 5 %; 10³ to 10⁸), the same for a seed on every machine, with two
/// named cameras and a light. Holds nothing but the result in memory. Throws Error for an unknown name or a count out of range.
[[nodiscard]] Scene make_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed);

/// Fills vertices, triangles, materials, cameras and lights; `make_procedural` has checked the count and completes the scene.
using ProceduralMaker = void (*)(Scene& scene, std::int64_t triangles, std::uint64_t seed);

/// A static object of this at the end of a generator's file (scenes/procedural/NAME.cpp) adds the scene.
struct ProceduralRegistration {
  ProceduralRegistration(std::string name, std::string summary, ProceduralMaker make);
};

}  // namespace raystudy
