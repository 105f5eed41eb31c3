#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "harness/scene/catalog.h"
#include "harness/scene/procedural.h"
#include "harness/spec/cell_id.h"
#include "harness/spec/read_method.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

std::vector<std::string> scene_names(const Catalog& catalog) {
  std::vector<std::string> names;
  for (const ProceduralInfo& info : procedural_scenes()) names.push_back(info.name);
  for (const CatalogEntry& entry : catalog.entries) names.push_back(entry.name);
  return names;
}

/// A file outside the catalog is known by its bytes. One that is not there yet has a name only; it cannot be measured either.
std::string file_identity(const std::string& path) { return fmt::format("{} xxh3={}", path, file_hash(path).value_or("none")); }

/// What the catalog promises of a scene. `open_scene` holds its files to this, so they need not be read here, but for one that
/// the user added by hand, of which it promises nothing.
std::string catalog_identity(const CatalogEntry& entry) {
  std::string text = fmt::format("{} triangles={}", entry.name, entry.triangles);
  for (const CatalogFile& file : entry.files) text += fmt::format(" sha256={}", file.sha256);
  if (const CatalogFile* installed = installed_file(entry); installed != nullptr && installed->sha256.empty()) {
    text += " " + file_identity(find_file(*installed)->string());
  }
  const auto triple = [](const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); };
  for (const Camera& camera : entry.cameras) {
    text += fmt::format(" camera {}: {}, {}, {}, {}", camera.name, triple(camera.eye), triple(camera.target), triple(camera.up),
                        camera.vertical_fov);
  }
  return text;
}

class SceneReader {
 public:
  SceneReader(Reading& reading, Plan& plan)
      : reading_(reading), plan_(plan), catalog_(read_catalog(catalog_path())), known_(scene_names(catalog_)) {}

  void read(const YamlNode& written) {
    const YamlNode& node = reading_.at_scale(written);
    if (node.is_scalar()) {
      read_scene_spec(node.text, node.where, nullptr);
    } else if (node.is_map() && node.entries.size() == 1) {
      const YamlEntry& entry = node.entries.front();
      read_scene_spec(entry.key, entry.where, entry.value.get());
    } else {
      const std::string found = node.is_map() ? fmt::format("a map of {} keys", node.entries.size()) : described(node);
      reading_.report(node.where, fmt::format("a scene is {}", found), "NAME or 'NAME: {triangles, seed, label}'");
    }
  }

 private:
  void read_scene_spec(const std::string& name, const SourceLocation& where, const YamlNode* options) {
    reading_.declared["scene"].insert(name);
    const bool is_file = name.find('/') != std::string::npos;
    if (!is_file && std::find(known_.begin(), known_.end(), name) == known_.end()) {
      reading_.report(where, fmt::format("there is no scene '{}'", name), "a name that 'raystudy list scenes' shows",
                      nearest_name(name, known_));
      return;
    }
    SceneSpec scene;
    scene.name = name;
    scene.base = is_file ? std::filesystem::path(name).stem().string() : name;
    scene.where = where;
    const ProceduralInfo* generator = find_procedural(name);
    const bool generated = generator != nullptr;
    std::vector<std::int64_t> counts{0};
    if (options != nullptr && !options->is_null()) {
      Fields fields(reading_, *options, fmt::format("scene '{}'", name));
      scene.base = fields.text("label", scene.base);
      reading_.declared["scene"].insert(scene.base);
      if (generated) {
        scene.seed =
            static_cast<std::uint64_t>(std::get<std::int64_t>(fields.value(integer_param("seed", 1, "", 0, 9007199254740992.0))));
        counts = read_counts(fields, scene, generator->triangles_max());
      }
      fields.finish();
    } else if (generated) {
      report_no_count(where, name);
      return;
    }
    for (const std::int64_t count : counts) {
      scene.triangles = count;
      scene.identity = generated ? fmt::format("{} triangles={} seed={}", name, count, scene.seed)
                       : is_file ? file_identity(name)
                                 : catalog_identity(*catalog_.find(name));
      scene.label = counts.size() == 1 ? scene.base : fmt::format("{}[triangles={}]", scene.base, count);
      add(scene);
    }
  }

  void report_no_count(const SourceLocation& where, const std::string& name) {
    reading_.report(where, fmt::format("scene '{}' is made to measure and has no triangle count", name),
                    fmt::format("a count, such as '{}: {{triangles: 100000}}'", name));
  }

  /// The triangle counts of a generator: one, or those of a list, up to `most`. Empty where they are wrong.
  std::vector<std::int64_t> read_counts(Fields& fields, const SceneSpec& scene, std::int64_t most) {
    const YamlNode* node = fields.find("triangles");
    if (node == nullptr) {
      if (fields.is_map()) report_no_count(scene.where, scene.name);
      return {};
    }
    const ParamSpec spec =
        integer_param("triangles", 0, "", static_cast<double>(procedural_triangles_min), static_cast<double>(most));
    std::vector<const YamlNode*> values{node};
    if (node->is_list()) {
      values.clear();
      for (const auto& item : node->items) values.push_back(item.get());
      if (values.empty()) reading_.report(node->where, "'triangles' sweeps over an empty list", "at least one value");
    }
    std::vector<std::int64_t> counts;
    for (const YamlNode* value : values) {
      const auto count = read_scalar(reading_, reading_.at_scale(*value), spec, "'triangles'");
      if (count) counts.push_back(std::get<std::int64_t>(*count));
    }
    return counts;
  }

  void add(const SceneSpec& scene) {
    check_label(reading_, scene.where, scene.base);
    if (const auto other = index_of(plan_.scenes, scene.label)) {
      reading_.report(scene.where, fmt::format("two scenes are called '{}'", scene.label),
                      fmt::format("a 'label' for one of them; the first is on line {}", plan_.scenes[*other].where.line));
      return;
    }
    plan_.scenes.push_back(scene);
  }

  Reading& reading_;
  Plan& plan_;
  Catalog catalog_;
  std::vector<std::string> known_;
};

}  // namespace

std::vector<std::string> known_scene_names() { return scene_names(read_catalog(catalog_path())); }

void read_scenes(Reading& reading, const YamlNode& node, Plan& plan) {
  if (!node.is_list() || node.items.empty()) {
    reading.report(node.where, fmt::format("'scenes' is {}", node.is_list() ? "empty" : described(node)),
                   "a list of scenes, such as '[sibenik-ogre]'");
    return;
  }
  SceneReader reader(reading, plan);
  for (const auto& item : node.items) reader.read(*item);
}

}  // namespace raystudy
