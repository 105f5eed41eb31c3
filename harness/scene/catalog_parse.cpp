#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "harness/base/yaml.h"
#include "harness/scene/catalog.h"
#include "harness/scene/fetch.h"

namespace raystudy {
namespace {

/// Reads YAML values and keeps a diagnostic for each that is wrong.
class Parser {
 public:
  using Setters = std::map<std::string, std::function<void(const YamlNode&)>, std::less<>>;

  void complain(const SourceLocation& where, std::string message, std::string expected = {}, std::string nearest = {}) {
    found.push_back({where, std::move(message), std::move(expected), std::move(nearest)});
  }

  /// Hands each key's value to its setter; complains of unknown and missing keys (doubled ones are parse_yaml's).
  void map(const YamlNode& node, std::string_view what, const Setters& setters, const std::vector<std::string>& required = {}) {
    if (!node.is_map()) return complain(node.where, fmt::format("{} is {}", what, described(node)), "a map of keys and values");
    std::vector<std::string> known;
    for (const auto& [key, setter] : setters) known.push_back(key);
    for (const YamlEntry& entry : node.entries) {
      const auto setter = setters.find(entry.key);
      if (setter != setters.end()) {
        setter->second(*entry.value);
      } else {
        complain(entry.where, fmt::format("unknown key '{}' in {}", entry.key, what),
                 fmt::format("one of {}", fmt::join(known, ", ")), nearest_name(entry.key, known));
      }
    }
    for (const std::string& key : required) {
      if (node.find(key) == nullptr) complain(node.where, fmt::format("{} has no '{}'", what, key));
    }
  }
  void list(const YamlNode& node, std::string_view key, const std::function<void(const YamlNode&)>& each) {
    if (!node.is_list()) return complain(node.where, fmt::format("'{}' is {}", key, described(node)), "a list");
    for (const auto& item : node.items) each(*item);
  }
  void text(const YamlNode& node, std::string_view key, std::string& out) {
    if (!node.is_scalar() || node.text.empty()) {
      return complain(node.where, fmt::format("'{}' is {}", key, described(node)), "a text");
    }
    out = node.text;
  }
  template <class T>
  void number(const YamlNode& node, std::string_view key, T& out, double low, double high, std::string_view expected) {
    T value{};
    const bool good = node.is_scalar() && parse_number(node.text, value) && static_cast<double>(value) >= low &&
                      static_cast<double>(value) <= high;
    if (!good) return complain(node.where, fmt::format("'{}' is {}", key, described(node)), std::string(expected));
    out = value;
  }
  void vec3(const YamlNode& node, std::string_view key, Vec3& out) {
    Vec3 value;
    bool good = node.is_list() && node.items.size() == 3;
    for (std::size_t k = 0; good && k < 3; ++k) {
      good = node.items[k]->is_scalar() && parse_number(node.items[k]->text, value[static_cast<int>(k)]);
    }
    if (!good || !is_finite(value)) {
      return complain(node.where, fmt::format("'{}' is {}", key, described(node)), "three numbers, e.g. [0, 1, 0]");
    }
    out = value;
  }

  std::vector<Diagnostic> found;

 private:
  template <class T>
  static bool parse_number(std::string_view text, T& value) {
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size();
  }
};

bool is_sha256(std::string_view text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

CatalogFile parse_file(Parser& p, const YamlNode& node) {
  CatalogFile file;
  file.where = node.where;
  const auto sha = [&](const YamlNode& n) {
    p.text(n, "sha256", file.sha256);
    if (!file.sha256.empty() && !is_sha256(file.sha256)) {
      p.complain(n.where, fmt::format("'sha256' is '{}'", file.sha256), "64 lower-case hex digits");
    }
  };
  const auto get = [&](const YamlNode& n) {
    p.text(n, "get", file.get);
    if (file.get.empty()) return;
    try {
      (void)parse_source(file.get);
    } catch (const Error& error) {
      p.complain(n.where, error.diagnostics().front().message, error.diagnostics().front().expected);
    }
  };
  p.map(node, "a file", {{"path", [&](const YamlNode& n) { p.text(n, "path", file.path); }}, {"sha256", sha}, {"get", get}},
        {"path"});
  if (!file.get.empty() && file.sha256.empty()) p.complain(node.where, "a file with 'get' has no 'sha256'");
  return file;
}

Camera parse_camera(Parser& p, const YamlNode& node) {
  Camera camera;
  const std::size_t complaints = p.found.size();
  p.map(node, "a camera",
        {{"name", [&](const YamlNode& n) { p.text(n, "name", camera.name); }},
         {"eye", [&](const YamlNode& n) { p.vec3(n, "eye", camera.eye); }},
         {"target", [&](const YamlNode& n) { p.vec3(n, "target", camera.target); }},
         {"up", [&](const YamlNode& n) { p.vec3(n, "up", camera.up); }},
         {"fov", [&](const YamlNode& n) { p.number(n, "fov", camera.vertical_fov, 1, 170, "degrees from 1 to 170"); }}},
        {"name", "eye", "target"});
  if (p.found.size() == complaints && length(cross(camera.target - camera.eye, camera.up)) == 0) {
    p.complain(node.where, "the camera's 'up' is along its view or its eye is its target");
  }
  return camera;
}

Light parse_light(Parser& p, const YamlNode& node) {
  Light light;
  bool has_position = false;
  p.map(node, "a light",
        {{"name", [&](const YamlNode& n) { p.text(n, "name", light.name); }},
         {"position", [&](const YamlNode& n) { p.vec3(n, "position", light.position), has_position = true; }},
         {"direction", [&](const YamlNode& n) { p.vec3(n, "direction", light.position), light.point_at_infinity = true; }},
         {"intensity", [&](const YamlNode& n) { p.vec3(n, "intensity", light.intensity); }}},
        {"name"});
  if (node.is_map() && has_position == light.point_at_infinity) {
    p.complain(node.where, "a light needs either 'position' or 'direction'");
  }
  return light;
}

Material parse_material(Parser& p, const YamlNode& node) {
  Material material{.name = "catalog"};
  const auto kind = [&](const YamlNode& n) {
    static const std::map<std::string, MaterialKind, std::less<>> kinds{{"diffuse", MaterialKind::diffuse},
                                                                        {"reflective", MaterialKind::reflective},
                                                                        {"refractive", MaterialKind::refractive},
                                                                        {"emitter", MaterialKind::emitter}};
    const auto found = kinds.find(n.text);
    if (found == kinds.end()) {
      return p.complain(n.where, fmt::format("'kind' is {}", described(n)), "diffuse, reflective, refractive or emitter",
                        nearest_name(n.text, {"diffuse", "reflective", "refractive", "emitter"}));
    }
    material.kind = found->second;
  };
  p.map(node, "a material",
        {{"kind", kind},
         {"color", [&](const YamlNode& n) { p.vec3(n, "color", material.color); }},
         {"emission", [&](const YamlNode& n) { p.vec3(n, "emission", material.emission); }},
         {"refraction-index",
          [&](const YamlNode& n) { p.number(n, "refraction-index", material.refraction_index, 1, 10, "1 to 10"); }}},
        {"kind"});
  return material;
}

CatalogEntry parse_entry(Parser& p, const YamlEntry& named) {
  const YamlNode& node = *named.value;
  CatalogEntry entry;
  entry.name = named.key;
  entry.where = named.where;
  p.map(node, fmt::format("scene '{}'", entry.name),
        {{"title", [&](const YamlNode& n) { p.text(n, "title", entry.title); }},
         {"source", [&](const YamlNode& n) { p.text(n, "source", entry.source); }},
         {"licence", [&](const YamlNode& n) { p.text(n, "licence", entry.licence); }},
         {"by-hand", [&](const YamlNode& n) { p.text(n, "by-hand", entry.by_hand); }},
         {"triangles",
          [&](const YamlNode& n) {
            p.number(n, "triangles", entry.triangles, 1, 2147483647, "a whole number from 1 to 2147483647");
          }},
         {"files",
          [&](const YamlNode& n) { p.list(n, "files", [&](const YamlNode& i) { entry.files.push_back(parse_file(p, i)); }); }},
         {"frames",
          [&](const YamlNode& n) {
            p.list(n, "frames", [&](const YamlNode& i) { entry.frames.push_back(parse_file(p, i)); });
            if (n.is_list() && n.items.empty()) p.complain(n.where, "'frames' has no file", "one at least, or no 'frames'");
          }},
         {"material", [&](const YamlNode& n) { entry.material = parse_material(p, n); }},
         {"lights",
          [&](const YamlNode& n) { p.list(n, "lights", [&](const YamlNode& i) { entry.lights.push_back(parse_light(p, i)); }); }},
         {"cameras",
          [&](const YamlNode& n) {
            p.list(n, "cameras", [&](const YamlNode& i) { entry.cameras.push_back(parse_camera(p, i)); });
          }}},
        {"title", "source", "licence", "files"});
  if (node.is_map() && entry.by_hand.empty() && node.find("triangles") == nullptr) {
    p.complain(named.where, fmt::format("scene '{}' has no 'triangles'", entry.name), "a count, or 'by-hand'");
  }
  if (node.is_map() && node.find("files") != nullptr && entry.files.empty()) {
    p.complain(named.where, fmt::format("scene '{}' has no file", entry.name), "at least one");
  }
  std::set<std::string> names;
  for (const Camera& camera : entry.cameras) {
    if (!names.insert(camera.name).second) {
      p.complain(named.where, fmt::format("scene '{}' has two cameras '{}'", entry.name, camera.name));
    }
  }
  for (const CatalogFile& file : entry.files) {
    if (!file.sha256.empty() || !entry.by_hand.empty()) continue;
    p.found.push_back(
        {file.where, fmt::format("scene '{}' has a file without 'sha256'", entry.name), "a hash, or 'by-hand' in the scene", {}});
  }
  return entry;
}

}  // namespace

Catalog read_catalog(const std::filesystem::path& file) {
  Catalog catalog{file.string(), {}};
  Parser p;
  const auto root = read_yaml(catalog.file, p.found);
  const auto scenes = [&](const YamlNode& node) {
    if (!node.is_map()) {
      return p.complain(node.where, fmt::format("'scenes' is {}", described(node)), "a map of names and scenes");
    }
    for (const YamlEntry& entry : node.entries) catalog.entries.push_back(parse_entry(p, entry));
  };
  p.map(*root, "the catalog", {{"scenes", scenes}}, {"scenes"});
  if (!p.found.empty()) throw Error(std::move(p.found));
  return catalog;
}

}  // namespace raystudy
