#include "harness/scene/open.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/scene/bytes.h"
#include "harness/scene/load.h"
#include "harness/scene/parsed_cache.h"
#include "harness/scene/procedural.h"
#include "harness/scene/read.h"

namespace raystudy {
namespace {

bool is_path(std::string_view name) { return name.find('/') != std::string_view::npos; }

bool is_procedural(std::string_view name) { return find_procedural(name) != nullptr; }

Scene open_procedural(std::string_view name, std::int64_t triangles, std::uint64_t seed) {
  const int version = find_procedural(name)->cache_version;
  if (version == 0) return make_procedural(name, triangles, seed);
  const std::string key = xxh3_hex(fmt::format("procedural {} {} {} version {}", name, triangles, seed, version));
  if (auto cached = find_parsed(key, name)) return std::move(cached->scene);
  Scene scene = make_procedural(name, triangles, seed);
  keep_parsed(key, {scene, {}, {}});
  return scene;
}

FileToRead to_read(const CatalogFile& file, const CatalogEntry& entry) {
  const auto path = find_file(file);
  if (!path) throw SceneNotInstalled(not_installed_text(entry));
  return {*path, file.sha256, file.where};
}

Scene open_entry(const CatalogEntry& entry) {
  const CatalogFile* file = installed_file(entry);
  if (file == nullptr) throw SceneNotInstalled(not_installed_text(entry));
  std::vector<FileToRead> frames;
  for (const CatalogFile& frame : entry.frames) frames.push_back(to_read(frame, entry));
  const FileToRead model = to_read(*file, entry);
  const std::string path = model.path.string();
  Scene scene = load_scene(model, frames);
  if (entry.triangles != 0 && static_cast<std::int64_t>(scene.triangles.size()) != entry.triangles) {
    throw Error(Diagnostic{{path, 0, 0},
                           fmt::format("scene '{}' has {} triangles", entry.name, scene.triangles.size()),
                           fmt::format("{}, as {} says", entry.triangles, entry.where.text()),
                           {}});
  }
  scene.name = entry.name;
  if (!entry.cameras.empty()) scene.cameras = entry.cameras;
  if (!entry.lights.empty()) scene.lights = entry.lights;
  if (entry.material) {
    scene.materials = {*entry.material};
    scene.triangle_materials = {};
    finish_scene(scene, path);
  }
  return scene;
}

}  // namespace

std::string not_installed_text(const CatalogEntry& entry) {
  const auto can_get = [](const CatalogFile& file) { return !file.get.empty(); };
  const auto by_hand = [&entry](const CatalogFile& file) {
    return entry.by_hand.empty() ? fmt::format("put the file at {} below a folder of RAYSTUDY_SCENES", file.path) : entry.by_hand;
  };
  if (installed_file(entry) == nullptr && std::none_of(entry.files.begin(), entry.files.end(), can_get)) {
    return fmt::format("scene not installed: {}; {}", entry.name, by_hand(entry.files.front()));
  }
  for (std::size_t i = 0; i < entry.frames.size(); ++i) {
    const CatalogFile& frame = entry.frames[i];
    if (can_get(frame) || find_file(frame)) continue;
    return fmt::format("scene not installed: {} lacks file {} of {} with frames, {}; {}", entry.name, i + 1, entry.frames.size(),
                       frame.path, by_hand(frame));
  }
  return fmt::format("scene not installed: raystudy scene get {}", entry.name);
}

const CatalogEntry& catalog_entry(const Catalog& catalog, std::string_view name) {
  if (const CatalogEntry* entry = catalog.find(name)) return *entry;
  std::vector<std::string> known;
  for (const ProceduralInfo& info : procedural_scenes()) known.push_back(info.name);
  for (const CatalogEntry& entry : catalog.entries) known.push_back(entry.name);
  throw Error(Diagnostic{
      {}, fmt::format("there is no scene '{}'", name), "a name that 'raystudy scene list' shows", nearest_name(name, known)});
}

Scene open_scene(const Catalog& catalog, std::string_view name, std::int64_t triangles, std::uint64_t seed) {
  if (is_path(name)) return read_scene(name);
  if (is_procedural(name)) return open_procedural(name, triangles, seed);
  return open_entry(catalog_entry(catalog, name));
}

Scene open_scene(std::string_view name, std::int64_t triangles, std::uint64_t seed) {
  const bool needs_catalog = !is_path(name) && !is_procedural(name);
  return open_scene(needs_catalog ? read_catalog(catalog_path()) : Catalog{}, name, triangles, seed);
}

std::optional<std::string> why_not_installed(const Catalog& catalog, std::string_view name) {
  const CatalogEntry* entry = is_path(name) || is_procedural(name) ? nullptr : catalog.find(name);
  if (entry == nullptr) return std::nullopt;
  if (is_installed(*entry)) return std::nullopt;
  return not_installed_text(*entry);
}

}  // namespace raystudy
