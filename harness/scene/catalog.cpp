#include "harness/scene/catalog.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "harness/scene/source.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// Reads YAML values and keeps a diagnostic for each that is wrong.
class Parser {
 public:
  explicit Parser(std::string file) : file_(std::move(file)) {}

  using Setters = std::map<std::string, std::function<void(const YAML::Node&)>, std::less<>>;

  [[nodiscard]] SourceLocation at(const YAML::Node& node) const { return {file_, node.Mark().line + 1, node.Mark().column + 1}; }
  void complain(const YAML::Node& node, std::string message, std::string expected = {}, std::string nearest = {}) {
    found_.push_back({at(node), std::move(message), std::move(expected), std::move(nearest)});
  }

  /// Hands each key's value to its setter; complains of unknown, doubled and missing keys.
  void map(const YAML::Node& node, std::string_view what, const Setters& setters, const std::vector<std::string>& required = {}) {
    if (!node.IsMap()) return complain(node, fmt::format("{} is not a map", what), "keys and values");
    std::vector<std::string> known;
    for (const auto& [key, setter] : setters) known.push_back(key);
    std::set<std::string> seen;
    for (const auto& pair : node) {
      const auto key = pair.first.as<std::string>("");
      const auto setter = setters.find(key);
      if (!seen.insert(key).second) {
        complain(pair.first, fmt::format("the key '{}' stands twice in {}", key, what));
      } else if (setter == setters.end()) {
        complain(pair.first, fmt::format("unknown key '{}' in {}", key, what), fmt::format("one of {}", fmt::join(known, ", ")),
                 nearest_name(key, known));
      } else {
        setter->second(pair.second);
      }
    }
    for (const std::string& key : required) {
      if (!seen.contains(key)) complain(node, fmt::format("{} has no '{}'", what, key));
    }
  }
  void list(const YAML::Node& node, std::string_view what, const std::function<void(const YAML::Node&)>& each) {
    if (!node.IsSequence()) return complain(node, fmt::format("{} is not a list", what), "a list");
    for (const YAML::Node& item : node) each(item);
  }
  void text(const YAML::Node& node, std::string_view key, std::string& out) {
    if (!node.IsScalar() || node.Scalar().empty()) return complain(node, fmt::format("'{}' is not a text", key), "a text");
    out = node.Scalar();
  }
  template <class T>
  void number(const YAML::Node& node, std::string_view key, T& out, double low, double high, std::string_view expected) {
    T value{};
    if (!node.IsScalar() || !YAML::convert<T>::decode(node, value) ||
        !(static_cast<double>(value) >= low && static_cast<double>(value) <= high)) {
      return complain(node, fmt::format("'{}' is {}", key, node.IsScalar() ? "'" + node.Scalar() + "'" : "not a number"),
                      std::string(expected));
    }
    out = value;
  }
  void vec3(const YAML::Node& node, std::string_view key, Vec3& out) {
    Vec3 value;
    bool good = node.IsSequence() && node.size() == 3;
    for (int axis = 0; good && axis < 3; ++axis) good = YAML::convert<float>::decode(node[axis], value[axis]);
    if (!good || !is_finite(value))
      return complain(node, fmt::format("'{}' is not a vector", key), "three numbers, e.g. [0, 1, 0]");
    out = value;
  }

  [[nodiscard]] std::vector<Diagnostic>& found() { return found_; }

 private:
  std::string file_;
  std::vector<Diagnostic> found_;
};

bool is_sha256(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

CatalogFile parse_file(Parser& p, const YAML::Node& node) {
  CatalogFile file;
  file.where = p.at(node);
  const auto sha = [&](const YAML::Node& n) {
    p.text(n, "sha256", file.sha256);
    if (!file.sha256.empty() && !is_sha256(file.sha256))
      p.complain(n, fmt::format("'sha256' is '{}'", file.sha256), "64 lower-case hex digits");
  };
  const auto get = [&](const YAML::Node& n) {
    p.text(n, "get", file.get);
    const auto is = [&](std::string_view scheme) { return file.get.starts_with(scheme); };
    if (!file.get.empty() && !is("https://") && !is("npm:") && !is("deb:")) {
      p.complain(n, fmt::format("'get' is '{}'", file.get), "https://…, npm:package@version#path or deb:package#path");
    }
  };
  p.map(node, "a file", {{"path", [&](const YAML::Node& n) { p.text(n, "path", file.path); }}, {"sha256", sha}, {"get", get}},
        {"path"});
  if (!file.get.empty() && file.sha256.empty()) p.complain(node, "a file with 'get' has no 'sha256'");
  return file;
}

Camera parse_camera(Parser& p, const YAML::Node& node) {
  Camera camera;
  p.map(node, "a camera",
        {{"name", [&](const YAML::Node& n) { p.text(n, "name", camera.name); }},
         {"eye", [&](const YAML::Node& n) { p.vec3(n, "eye", camera.eye); }},
         {"target", [&](const YAML::Node& n) { p.vec3(n, "target", camera.target); }},
         {"up", [&](const YAML::Node& n) { p.vec3(n, "up", camera.up); }},
         {"fov", [&](const YAML::Node& n) { p.number(n, "fov", camera.vertical_fov, 1, 170, "degrees from 1 to 170"); }}},
        {"name", "eye", "target"});
  if (node.IsMap() && length(cross(camera.target - camera.eye, camera.up)) == 0) {
    p.complain(node, "the camera's 'up' is along its view or its eye is its target");
  }
  return camera;
}

Light parse_light(Parser& p, const YAML::Node& node) {
  Light light;
  bool has_position = false;
  p.map(node, "a light",
        {{"name", [&](const YAML::Node& n) { p.text(n, "name", light.name); }},
         {"position", [&](const YAML::Node& n) { p.vec3(n, "position", light.position), has_position = true; }},
         {"direction", [&](const YAML::Node& n) { p.vec3(n, "direction", light.position), light.point_at_infinity = true; }},
         {"intensity", [&](const YAML::Node& n) { p.vec3(n, "intensity", light.intensity); }}},
        {"name"});
  if (node.IsMap() && has_position == light.point_at_infinity) p.complain(node, "a light needs either 'position' or 'direction'");
  return light;
}

Material parse_material(Parser& p, const YAML::Node& node) {
  Material material{.name = "catalog"};
  const auto kind = [&](const YAML::Node& n) {
    static const std::map<std::string, MaterialKind, std::less<>> kinds{{"diffuse", MaterialKind::diffuse},
                                                                        {"reflective", MaterialKind::reflective},
                                                                        {"refractive", MaterialKind::refractive},
                                                                        {"emitter", MaterialKind::emitter}};
    const auto found = kinds.find(n.IsScalar() ? n.Scalar() : "");
    if (found == kinds.end()) {
      return p.complain(n, fmt::format("'kind' is '{}'", n.IsScalar() ? n.Scalar() : "no text"),
                        "diffuse, reflective, refractive or emitter",
                        n.IsScalar() ? nearest_name(n.Scalar(), {"diffuse", "reflective", "refractive", "emitter"}) : "");
    }
    material.kind = found->second;
  };
  p.map(node, "a material",
        {{"kind", kind},
         {"color", [&](const YAML::Node& n) { p.vec3(n, "color", material.color); }},
         {"emission", [&](const YAML::Node& n) { p.vec3(n, "emission", material.emission); }},
         {"refraction-index",
          [&](const YAML::Node& n) { p.number(n, "refraction-index", material.refraction_index, 1, 10, "1 to 10"); }}},
        {"kind"});
  return material;
}

CatalogEntry parse_entry(Parser& p, const YAML::Node& key, const YAML::Node& node) {
  CatalogEntry entry;
  entry.name = key.Scalar();
  entry.where = p.at(key);
  p.map(node, fmt::format("scene '{}'", entry.name),
        {{"title", [&](const YAML::Node& n) { p.text(n, "title", entry.title); }},
         {"source", [&](const YAML::Node& n) { p.text(n, "source", entry.source); }},
         {"licence", [&](const YAML::Node& n) { p.text(n, "licence", entry.licence); }},
         {"by-hand", [&](const YAML::Node& n) { p.text(n, "by-hand", entry.by_hand); }},
         {"triangles",
          [&](const YAML::Node& n) {
            p.number(n, "triangles", entry.triangles, 1, 2147483647, "a whole number from 1 to 2147483647");
          }},
         {"files",
          [&](const YAML::Node& n) {
            p.list(n, "'files'", [&](const YAML::Node& i) { entry.files.push_back(parse_file(p, i)); });
          }},
         {"frames",
          [&](const YAML::Node& n) {
            p.list(n, "'frames'", [&](const YAML::Node& i) { entry.frames.push_back(parse_file(p, i)); });
          }},
         {"material", [&](const YAML::Node& n) { entry.material = parse_material(p, n); }},
         {"lights",
          [&](const YAML::Node& n) {
            p.list(n, "'lights'", [&](const YAML::Node& i) { entry.lights.push_back(parse_light(p, i)); });
          }},
         {"cameras",
          [&](const YAML::Node& n) {
            p.list(n, "'cameras'", [&](const YAML::Node& i) { entry.cameras.push_back(parse_camera(p, i)); });
          }}},
        {"title", "source", "licence", "triangles", "files"});
  std::set<std::string> names;
  for (const Camera& camera : entry.cameras) {
    if (!names.insert(camera.name).second)
      p.complain(key, fmt::format("scene '{}' has two cameras '{}'", entry.name, camera.name));
  }
  for (const CatalogFile& file : entry.files) {
    if (!file.sha256.empty() || !entry.by_hand.empty()) continue;
    p.found().push_back(
        {file.where, fmt::format("scene '{}' has a file without 'sha256'", entry.name), "a hash, or 'by-hand' in the scene", {}});
  }
  return entry;
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

const CatalogEntry* Catalog::find(std::string_view name) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [name](const CatalogEntry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

fs::path catalog_path() {
  if (const std::string file = variable("RAYSTUDY_CATALOG"); !file.empty()) return file;
  if (fs::path file = RAYSTUDY_SOURCE_CATALOG; fs::exists(file)) return file;
  return RAYSTUDY_INSTALLED_CATALOG;
}

Catalog read_catalog(const fs::path& file) {
  Catalog catalog{file.string(), {}};
  const Bytes bytes = map_file(file);
  Parser p(catalog.file);
  YAML::Node root;
  try {
    root = YAML::Load(std::string(as_text(bytes)));
  } catch (const YAML::Exception& error) {
    throw Error(Diagnostic{{catalog.file, error.mark.line + 1, error.mark.column + 1}, error.msg, "YAML", {}});
  }
  const auto scenes = [&](const YAML::Node& node) {
    if (!node.IsMap()) return p.complain(node, "'scenes' is not a map", "names and scenes");
    for (const auto& pair : node) {
      if (catalog.find(pair.first.Scalar()) != nullptr)
        p.complain(pair.first, fmt::format("there are two scenes '{}'", pair.first.Scalar()));
      catalog.entries.push_back(parse_entry(p, pair.first, pair.second));
    }
  };
  p.map(root, "the catalog", {{"scenes", scenes}}, {"scenes"});
  if (!p.found().empty()) throw Error(std::move(p.found()));
  return catalog;
}

std::optional<fs::path> user_cache() {
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty()) return fs::path(cache) / "raystudy";
  if (const std::string home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache/raystudy";
  return std::nullopt;
}

std::vector<fs::path> scene_folders() {
  std::vector<fs::path> folders;
  const std::string list = variable("RAYSTUDY_SCENES");
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(':', begin), list.size());
    if (end > begin) folders.emplace_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  if (const auto cache = user_cache()) folders.push_back(*cache / "scenes");
  return folders;
}

std::optional<fs::path> find_file(const CatalogFile& file) {
  for (const fs::path& folder : scene_folders()) {
    std::error_code ignored;
    for (fs::path p = folder / file.path; p != folder && !p.empty(); p = p.parent_path()) {
      if (fs::is_regular_file(p, ignored)) return folder / file.path;
    }
  }
  return std::nullopt;
}

const CatalogFile* installed_file(const CatalogEntry& entry) {
  for (const CatalogFile& file : entry.files) {
    if (find_file(file)) return &file;
  }
  return nullptr;
}

}  // namespace raystudy
