// OBJ geometry, read here rather than by tinyobjloader: that takes a malformed number for 0 without a word, and knows no lines.
// Material libraries are tinyobjloader's. Polygons are cut into fans; texture coordinates and normals are skipped.
#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "harness/scene/source.h"
#include "harness/scene/text_cursor.h"

namespace raystudy {
namespace {

// Statements of the format that do not make triangles. Others are mistakes: a misspelt 'f' must not lose a face.
constexpr std::array<std::string_view, 42> skipped{
    "vt",       "vn",       "vp",    "l",    "p",          "o",         "g",     "s",     "mg",     "usemap", "maplib",
    "d_interp", "c_interp", "bevel", "lod",  "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg",    "bmat",
    "step",     "curv",     "curv2", "surf", "parm",       "trim",      "hole",  "scrv",  "sp",     "end",    "con",
    "bsp",      "bzp",      "cdc",   "cdp",  "res",        "call",      "csh",   "vm",    "fo"};

float largest(const tinyobj::real_t (&c)[3]) { return std::max({c[0], c[1], c[2]}); }
Vec3 vec3(const tinyobj::real_t (&c)[3]) { return {c[0], c[1], c[2]}; }

/// illum 3, 5 and 8 reflect, 4, 6, 7 and 9 refract (the MTL specification, 'illum').
Material converted(const tinyobj::material_t& m) {
  Material material{.name = m.name, .color = vec3(m.diffuse)};
  const bool mirrors = m.illum == 3 || m.illum == 5 || m.illum == 8;
  const bool transmits = m.illum == 4 || m.illum == 6 || m.illum == 7 || m.illum == 9;
  if (largest(m.emission) > 0) {
    material.kind = MaterialKind::emitter;
    material.emission = vec3(m.emission);
  } else if (transmits || m.dissolve < 1) {
    material.kind = MaterialKind::refractive;
    material.color = largest(m.transmittance) > 0 ? vec3(m.transmittance) : Vec3{1};
    material.refraction_index = m.ior;
  } else if (mirrors && largest(m.specular) > 0) {
    material.kind = MaterialKind::reflective;
    material.color = vec3(m.specular);
  }
  return material;
}

class ObjReader {
 public:
  explicit ObjReader(const SourceFile& source) : source_(source), cursor_(source) {}

  Scene read() {
    do {
      statement(cursor_.next_word_of_line());
    } while (cursor_.next_line());
    Scene scene;
    scene.vertices = SharedArray<Vec3>(std::move(vertices_));
    scene.triangles = SharedArray<Triangle>(std::move(triangles_));
    if (materials_.size() > 1) {
      scene.triangle_materials = SharedArray<std::uint32_t>(std::move(triangle_materials_));
    }
    scene.materials = std::move(materials_);
    return scene;
  }

 private:
  void statement(std::string_view keyword) {
    if (keyword.empty() || keyword[0] == '#') return;
    if (keyword == "v") return vertex();
    if (keyword == "f") return face();
    if (keyword == "usemtl") return use_material(std::string(cursor_.rest_of_line()));
    if (keyword == "mtllib") return libraries(std::string(cursor_.rest_of_line()));
    if (std::find(skipped.begin(), skipped.end(), keyword) != skipped.end()) return;
    static const std::vector<std::string> known{"v", "vt", "vn", "f", "usemtl", "mtllib"};
    cursor_.fail(fmt::format("unknown statement '{}'", shown(keyword)), "an OBJ statement such as v, f, usemtl or mtllib",
                 nearest_name(keyword, known));
  }

  /// The next word of the statement, which a backslash continues on the next line.
  std::string_view argument() {
    const std::string_view word = cursor_.next_word_of_line();
    if (word != "\\" || !cursor_.next_line()) return word;
    return argument();
  }

  void vertex() {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = argument();
      if (!TextCursor::parse(word, v[axis])) {
        cursor_.fail(word.empty() ? fmt::format("the vertex has {} coordinates", axis)
                                  : fmt::format("'{}' stands where a coordinate should", shown(word)),
                     word.empty() ? "three" : "a number");
      }
    }
    vertices_.push_back(v);
  }

  void face() {
    std::array<std::uint32_t, 3> corner{};
    int n = 0;
    for (std::string_view word = argument(); !word.empty(); word = argument(), ++n) {
      corner[static_cast<std::size_t>(std::min(n, 2))] = index(word);
      if (n < 2) continue;
      triangles_.push_back({corner});
      triangle_materials_.push_back(current_);
      corner[1] = corner[2];
    }
    if (n < 3) cursor_.fail(fmt::format("the face has {} corners", n), "3 or more");
  }

  /// The vertex of a corner such as 7, 7/1, 7//3 or -1/-1/-1. Faces may only refer back, as the format says of negative ones;
  /// positive ones ahead occur in the wild and are checked at the end by finish_scene.
  std::uint32_t index(std::string_view word) {
    const std::string_view digits = word.substr(0, word.find('/'));
    std::int64_t i = 0;
    if (!TextCursor::parse(digits, i)) {
      cursor_.fail(fmt::format("'{}' stands where a vertex index should", shown(word)), "a whole number");
    }
    const auto count = static_cast<std::int64_t>(vertices_.size());
    const std::int64_t from_zero = i < 0 ? count + i : i - 1;
    if (i == 0 || from_zero < 0 || from_zero > 0xfffffffeLL) {
      cursor_.fail(fmt::format("the face refers to vertex {}", i), fmt::format("1 to {} or -{} to -1", count, count));
    }
    return static_cast<std::uint32_t>(from_zero);
  }

  /// `mtllib a.mtl b.mtl`, or one name with blanks in it.
  void libraries(const std::string& names) {
    if (library(names)) return;
    std::istringstream words(names);
    for (std::string name; words >> name;) {
      if (!library(name)) {
        cursor_.fail(fmt::format("the material library '{}' is missing", shown(name)), "that file beside the model");
      }
    }
  }

  bool library(const std::string& name) {
    const auto bytes = source_.sibling(name);
    if (!bytes) return false;
    std::istringstream text{std::string(as_text(*bytes))};
    std::map<std::string, int> by_name;
    std::vector<tinyobj::material_t> read;
    std::string warning;
    std::string error;
    tinyobj::LoadMtl(&by_name, &read, &text, &warning, &error);
    if (!error.empty()) cursor_.fail(fmt::format("the material library '{}' is not readable: {}", shown(name), error));
    for (const tinyobj::material_t& m : read) library_[m.name] = converted(m);
    return true;
  }

  void use_material(const std::string& name) {
    const auto [slot, added] = slots_.try_emplace(name, static_cast<std::uint32_t>(materials_.size()));
    current_ = slot->second;
    if (!added) return;
    const auto known = library_.find(name);
    if (known == library_.end() && !library_.empty()) {
      std::vector<std::string> names;
      for (const auto& [n, m] : library_) names.push_back(n);
      cursor_.fail(fmt::format("unknown material '{}'", shown(name)), "one of the material library", nearest_name(name, names));
    }
    // Without any library the names still tell the parts of a model apart.
    materials_.push_back(known == library_.end() ? Material{.name = name} : known->second);
  }

  const SourceFile& source_;
  TextCursor cursor_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_materials_;
  std::map<std::string, Material> library_;
  std::map<std::string, std::uint32_t> slots_;
  std::vector<Material> materials_{{.name = "default"}};  ///< faces before the first usemtl have it
  std::uint32_t current_ = 0;
};

}  // namespace

Scene read_obj(const SourceFile& source) { return ObjReader(source).read(); }

}  // namespace raystudy
