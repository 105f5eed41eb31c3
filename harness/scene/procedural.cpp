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

ProceduralRegistration::ProceduralRegistration(std::string name, std::string summary, ProceduralMaker make, int frames,
                                               int cache_version) {
  auto& [infos, makers] = generators();
  const auto place = std::lower_bound(infos.begin(), infos.end(), name,
                                      [](const ProceduralInfo& info, const std::string& wanted) { return info.name < wanted; });
  makers.insert(makers.begin() + (place - infos.begin()), make);
  infos.insert(place, {std::move(name), std::move(summary), frames, cache_version});
}

const std::vector<ProceduralInfo>& procedural_scenes() { return generators().infos; }

const ProceduralInfo* find_procedural(std::string_view name) {
  const auto& all = procedural_scenes();
  const auto found = std::find_if(all.begin(), all.end(), [name](const ProceduralInfo& info) { return info.name == name; });
  return found == all.end() ? nullptr : &*found;
}

Scene make_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed) {
  const ProceduralInfo* info = find_procedural(name);
  if (info == nullptr) {
    std::vector<std::string> known;
    for (const ProceduralInfo& scene : procedural_scenes()) known.push_back(scene.name);
    throw Error(Diagnostic{{},
                           fmt::format("there is no procedural scene '{}'", name),
                           fmt::format("one of {}", fmt::join(known, ", ")),
                           nearest_name(name, known)});
  }
  if (triangles < procedural_triangles_min || triangles > info->triangles_max()) {
    throw Error(Diagnostic{{},
                           fmt::format("scene '{}' of {} triangles", name, triangles),
                           fmt::format("{} to {} triangles", procedural_triangles_min, info->triangles_max()),
                           {}});
  }
  Scene scene;
  scene.name = name;
  generators().makers[static_cast<std::size_t>(info - generators().infos.data())](scene, triangles, seed);
  finish_scene(scene, name);
  return scene;
}

}  // namespace raystudy
