#include "harness/scene/procedural.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <utility>

#include "harness/base/error.h"

namespace raystudy {
namespace {

struct Generators {
  std::vector<ProceduralInfo> infos;  // sorted by name
  std::vector<ProceduralMaker> makers;
};

Generators& generators() {
  static Generators all;
  return all;
}

}  // namespace

ProceduralRegistration::ProceduralRegistration(std::string name, std::string summary, ProceduralMaker make) {
  auto& [infos, makers] = generators();
  const auto place = std::lower_bound(infos.begin(), infos.end(), name,
                                      [](const ProceduralInfo& info, const std::string& wanted) { return info.name < wanted; });
  makers.insert(makers.begin() + (place - infos.begin()), make);
  infos.insert(place, {std::move(name), std::move(summary)});
}

const std::vector<ProceduralInfo>& procedural_scenes() { return generators().infos; }

Scene make_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed) {
  std::vector<std::string> known;
  for (const ProceduralInfo& info : procedural_scenes()) known.push_back(info.name);
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) {
    throw Error(Diagnostic{{},
                           fmt::format("there is no procedural scene '{}'", name),
                           fmt::format("one of {}", fmt::join(known, ", ")),
                           nearest_name(name, known)});
  }
  if (triangles < procedural_triangles_min || triangles > procedural_triangles_max) {
    throw Error(Diagnostic{{},
                           fmt::format("scene '{}' of {} triangles", name, triangles),
                           fmt::format("{} to {} triangles", procedural_triangles_min, procedural_triangles_max),
                           {}});
  }
  Scene scene;
  scene.name = name;
  generators().makers[static_cast<std::size_t>(found - known.begin())](scene, triangles, seed);
  finish_scene(scene, name);
  return scene;
}

}  // namespace raystudy
