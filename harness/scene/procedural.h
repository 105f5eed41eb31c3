#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/scene.h"

namespace raystudy {

inline constexpr std::int64_t procedural_triangles_min = 1'000;

/// A built-in scene that scales: its name and what it is for, in one line.
struct ProceduralInfo {
  std::string name;
  std::string summary;
  int frames = 0;  ///< key frames; 0: static
  /// Of a scene that takes longer to make than to load: open_scene keeps it in the parsed-scene cache. Raised with every change of
  /// what the generator makes; 0: not kept.
  int cache_version = 0;
  /// An animated scene holds every key frame in memory: at most 4 · 10⁶ triangles.
  [[nodiscard]] std::int64_t triangles_max() const { return frames == 0 ? 100'000'000 : 4'000'000; }
};
[[nodiscard]] const std::vector<ProceduralInfo>& procedural_scenes();
/// The scene of that name; null where there is none.
[[nodiscard]] const ProceduralInfo* find_procedural(std::string_view name);

/// Makes the scene with about `triangles` triangles (within 5 %; 10³ to `triangles_max`), the same for a seed on every machine,
/// with two named cameras and a light. Throws Error for an unknown name or a count out of range.
[[nodiscard]] Scene make_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed);

/// Fills vertices, triangles, materials, cameras and lights, and the frames of an animated scene; `make_procedural` has checked
/// the count and completes the scene.
using ProceduralMaker = void (*)(Scene& scene, std::int64_t triangles, std::uint64_t seed);

/// A static object of this at the end of a generator's file (scenes/procedural/NAME.cpp) adds the scene.
struct ProceduralRegistration {
  ProceduralRegistration(std::string name, std::string summary, ProceduralMaker make, int frames = 0, int cache_version = 0);
};

}  // namespace raystudy
