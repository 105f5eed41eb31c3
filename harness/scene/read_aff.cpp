// AFF, the animated extension of NFF in which the BART benchmark is written (Lext, Assarsson, Moller 2001): polygons, meshes,
// triangles that change their shape, scopes of fixed (xs) and key-framed (x) transforms, included files. Cones, of which BART's
// museum has eight, are left out with a warning, as is the motion of scopes whose key frames no file gives.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "harness/scene/aff_cursor.h"
#include "harness/scene/aff_model.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

constexpr int most_frames = 300;  ///< as many as the papers' key frames; of more the file asks for, so many equally spaced times
constexpr int deepest = 100;      ///< includes within includes

/// Where geometry lies: in a joint (none: -1) and the fixed scopes below it.
struct Scope {
  int joint = -1;
  Affine transform;
};
class AffReader {
 public:
  explicit AffReader(const SourceFile& source) : source_(source) {}

  Scene read() {
    scene_.materials.push_back({.name = "default"});
    read_file(source_, {}, 0);
    warn();
    model_.fill(scene_);
    return std::move(scene_);
  }

 private:
  void read_file(const SourceFile& file, const Scope& around, int depth) {
    if (depth > deepest) fail_at(file.name, fmt::format("files include each other deeper than {}", deepest), "no circle");
    AffCursor in(file);
    std::vector<Scope> scopes{around};
    for (std::string_view w = in.next(); !w.empty(); w = in.next()) {
      if (w == "}") {
        if (scopes.size() == 1) in.fail("'}' closes nothing", "'{' before it");
        scopes.pop_back();
      } else if (w == "i") {
        include(in, scopes.back(), depth);
      } else {
        command(in, w)(*this, in, scopes);
      }
    }
    if (scopes.size() != 1) in.fail(fmt::format("the file ends within {} scopes", scopes.size() - 1), "'}' for each '{'");
  }

  using Action = void (*)(AffReader&, AffCursor&, std::vector<Scope>&);
  static Action command(const AffCursor& in, std::string_view name) {
    static const std::map<std::string, Action, std::less<>> commands{
        {"a", [](AffReader& r, AffCursor& c, std::vector<Scope>&) { r.animation(c); }},
        {"am", [](AffReader&, AffCursor& c, std::vector<Scope>&) { c.skip(3, "the ambient light"); }},
        {"b", [](AffReader&, AffCursor& c, std::vector<Scope>&) { c.skip(3, "the background"); }},
        {"c",
         [](AffReader& r, AffCursor& c, std::vector<Scope>&) {
           c.skip(8, "a cone");
           ++r.cones_;
         }},
        {"fm", [](AffReader& r, AffCursor& c, std::vector<Scope>&) { r.material(c); }},
        {"k", [](AffReader& r, AffCursor& c, std::vector<Scope>&) { r.track(c); }},
        {"l", [](AffReader& r, AffCursor& c, std::vector<Scope>&) { r.light(c); }},
        {"m", [](AffReader& r, AffCursor& c, std::vector<Scope>& s) { r.mesh(c, s.back()); }},
        {"p", [](AffReader& r, AffCursor& c, std::vector<Scope>& s) { r.polygon(c, s.back()); }},
        {"tpa", [](AffReader& r, AffCursor& c, std::vector<Scope>& s) { r.morph(c, s.back()); }},
        {"tt", [](AffReader& r, AffCursor& c, std::vector<Scope>& s) { r.textured_triangle(c, s.back()); }},
        {"v", [](AffReader& r, AffCursor& c, std::vector<Scope>&) { r.view(c); }},
        {"x", [](AffReader& r, AffCursor& c, std::vector<Scope>& s) { r.open_moving(c, s); }},
        {"xs", [](AffReader&, AffCursor& c, std::vector<Scope>& s) { open_fixed(c, s); }}};
    if (const auto found = commands.find(name); found != commands.end()) return found->second;
    std::vector<std::string> known{"i", "}"};
    for (const auto& [key, action] : commands) known.push_back(key);
    in.fail(fmt::format("'{}' is no command of AFF that is read", shown(name)), fmt::format("one of {}", fmt::join(known, ", ")),
            nearest_name(name, known));
  }

  void include(AffCursor& in, const Scope& scope, int depth) {
    (void)in.number("the level of detail");
    const std::string name(in.word("a file's name"));
    auto found = files_.find(name);
    if (found == files_.end()) {
      const auto bytes = source_.sibling(name);
      if (!bytes) in.fail(fmt::format("there is no file '{}' beside {}", shown(name), source_.name), "an included file");
      const std::size_t slash = source_.name.rfind('/');
      SourceFile file{.name = slash == std::string::npos ? name : source_.name.substr(0, slash + 1) + name,
                      .stem = {},
                      .extension = "aff",
                      .bytes = *bytes,
                      .in_archive = source_.in_archive,
                      .sibling = {}};
      found = files_.emplace(name, std::move(file)).first;
    }
    read_file(found->second, scope, depth + 1);
  }

  static void open_fixed(AffCursor& in, std::vector<Scope>& scopes) {
    const auto scale = in.numbers<3>("a scale");
    const auto axis = in.numbers<3>("an axis");
    const double degrees = in.number("an angle");
    const auto translation = in.numbers<3>("a translation");
    in.open_brace("xs");
    scopes.push_back({scopes.back().joint, scopes.back().transform * affine_of(scale, turn_around(axis, degrees), translation)});
  }

  void open_moving(AffCursor& in, std::vector<Scope>& scopes) {
    std::string name(in.word("a name of key frames"));
    in.open_brace("x");
    model_.joints.push_back({std::move(name), scopes.back().joint, scopes.back().transform});
    scopes.push_back({static_cast<int>(model_.joints.size()) - 1, {}});
  }

  void animation(AffCursor& in) {
    const auto [begin, end, frames] = in.numbers<3>("the animation's begin, end and number of frames");
    if (!(begin < end) || frames < 2 || frames != std::floor(frames)) {
      in.fail(fmt::format("the animation has {} frames from {} to {}", frames, begin, end),
              "a whole number of frames, two at least, and time to pass");
    }
    model_.begin = begin;
    model_.end = end;
    model_.frame_count = static_cast<std::size_t>(std::min<double>(frames, most_frames));
  }

  void material(AffCursor& in) {
    in.skip(3, "an ambient colour");
    const Vec3 diffuse = in.point();
    in.skip(4, "a specular colour and its exponent");
    const double transmittance = in.number("a transmittance");
    const auto index = static_cast<float>(in.number("an index of refraction"));
    Material material{.name = fmt::format("material-{}", scene_.materials.size()), .color = diffuse};
    if (transmittance > 0) {
      material.kind = MaterialKind::refractive;
      material.color = Vec3{static_cast<float>(transmittance)};
      material.refraction_index = index > 0 ? index : 1;
    }
    scene_.materials.push_back(std::move(material));
  }

  void light(AffCursor& in) {
    const Vec3 position = in.point();
    scene_.lights.push_back(
        {.name = fmt::format("light-{}", scene_.lights.size() + 1), .position = position, .intensity = in.point()});
  }

  void view(AffCursor& in) {
    Camera camera;
    camera.name = "view";
    const auto expect = [&in](std::string_view wanted) {
      if (const std::string_view w = in.word(wanted); w != wanted) {
        in.fail(fmt::format("'{}' stands where '{}' should", shown(w), wanted), "from, at, up, angle, hither, resolution");
      }
    };
    expect("from");
    camera.eye = in.point();
    expect("at");
    camera.target = in.point();
    expect("up");
    camera.up = in.point();
    expect("angle");
    camera.vertical_fov = static_cast<float>(in.number("an angle"));
    expect("hither");
    in.skip(1, "the near plane");
    expect("resolution");
    in.skip(2, "the resolution");
    scene_.cameras.push_back(std::move(camera));
  }

  template <std::size_t N, class Value>
  std::vector<AffKey<N>> keys(AffCursor& in, std::string_view name, Value&& value) {
    const std::size_t n = in.count("keys");
    if (n < 4) in.fail(fmt::format("{} has {} keys", name, n), "four at least: the first and the last only shape the curve");
    std::vector<AffKey<N>> all(n);
    for (std::size_t k = 0; k < n; ++k) {
      all[k].time = in.number("a time");
      all[k].value = value();
      all[k].tension = in.number("a tension");
      all[k].continuity = in.number("a continuity");
      all[k].bias = in.number("a bias");
    }
    return all;
  }

  void track(AffCursor& in) {
    const std::string name(in.word("a name of key frames"));
    in.open_brace("k");
    AffTrack track;
    for (std::string_view w = in.word("'}'"); w != "}"; w = in.word("'}'")) {
      if (w == "transl") {
        track.translation = keys<3>(in, name, [&in] { return in.numbers<3>("a translation"); });
      } else if (w == "scale") {
        track.scale = keys<3>(in, name, [&in] { return in.numbers<3>("a scale"); });
      } else if (w == "rot") {
        track.rotation = keys<4>(in, name, [&in] {
          const auto axis = in.numbers<3>("an axis");
          return turn_around(axis, in.number("an angle"));
        });
      } else {
        in.fail(fmt::format("'{}' stands where keys of {} should", shown(w), name), "transl, rot or scale",
                nearest_name(w, {"transl", "rot", "scale"}));
      }
    }
    const auto [place, fresh] = model_.tracks.try_emplace(name, track);
    if (!fresh && !(place->second == track)) in.fail(fmt::format("the key frames '{}' are given twice", name), "once");
  }

  std::uint32_t new_place() {
    model_.triangle_materials.push_back(static_cast<std::uint32_t>(scene_.materials.size()) - 1);
    return static_cast<std::uint32_t>(model_.triangle_materials.size()) - 1;
  }

  /// Adds triangles of vertices in the scope's coordinates.
  void add(const Scope& scope, const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
    AffModel::Part& part = model_.parts[scope.joint];
    const auto base = static_cast<std::uint32_t>(part.positions.size());
    for (const Vec3 p : positions) part.positions.push_back(scope.transform.point(p));
    for (const Triangle& t : triangles) {
      part.triangles.push_back({{base + t[0], base + t[1], base + t[2]}});
      part.places.push_back(new_place());
    }
  }

  void polygon(AffCursor& in, const Scope& scope) {
    const std::size_t n = in.count("corners");
    if (n < 3) in.fail(fmt::format("a polygon has {} corners", n), "three or more");
    std::vector<Vec3> positions(n);
    for (Vec3& p : positions) p = in.point();
    std::vector<Triangle> fan;
    for (std::uint32_t i = 1; i + 1 < n; ++i) fan.push_back({{0, i, i + 1}});
    add(scope, positions, fan);
  }

  void textured_triangle(AffCursor& in, const Scope& scope) {
    (void)in.word("a texture's name");
    std::vector<Vec3> positions(3);
    for (Vec3& p : positions) {
      p = in.point();
      in.skip(2, "texture coordinates");
    }
    add(scope, positions, {Triangle{{0, 1, 2}}});
  }

  void mesh(AffCursor& in, const Scope& scope) {
    std::vector<Vec3> positions;
    std::size_t per_triangle = 0;  // indices of normals and texture coordinates
    for (std::string_view w = in.word("triangles"); w != "triangles"; w = in.word("triangles")) {
      if (w == "vertices") {
        positions.resize(in.count("vertices"));
        for (Vec3& p : positions) p = in.point();
      } else if (w == "normals") {
        in.skip(3 * in.count("normals"), "a normal");
        per_triangle += 3;
      } else if (w == "texturecoords") {
        const std::size_t n = in.count("texture coordinates");
        (void)in.word("a texture's name");
        in.skip(2 * n, "texture coordinates");
        per_triangle += 3;
      } else {
        in.fail(fmt::format("'{}' stands within a mesh", shown(w)), "vertices, normals, texturecoords or triangles");
      }
    }
    std::vector<Triangle> triangles(in.count("triangles"));
    for (Triangle& t : triangles) {
      for (std::uint32_t& v : t.vertex) {
        const double index = in.number("a vertex' index");
        if (!(index >= 0 && index < static_cast<double>(positions.size()))) {
          in.fail(fmt::format("a triangle refers to vertex {} of its mesh", index),
                  fmt::format("an index below {}", positions.size()));
        }
        v = static_cast<std::uint32_t>(index);
      }
      in.skip(per_triangle, "an index");
    }
    add(scope, positions, triangles);
  }

  void morph(AffCursor& in, const Scope& scope) {
    AffModel::Morph morph{scope.joint, new_place(), {}, {}};
    const std::size_t n = in.count("shapes of a triangle");
    if (n == 0) in.fail("a triangle has no shape", "one at least");
    for (std::size_t k = 0; k < n; ++k) {
      morph.times.push_back(in.number("a time"));
      if (k > 0 && !(morph.times[k] > morph.times[k - 1])) {
        in.fail(fmt::format("shape {} of a triangle is at {} s", k, morph.times[k]), "increasing times");
      }
      for (Vec3& p : morph.corners.emplace_back()) {
        p = scope.transform.point(in.point());
        in.skip(3, "a normal");
      }
    }
    model_.morphs.push_back(std::move(morph));
  }

  void warn() const {
    std::set<std::string> missing;
    for (const AffModel::Joint& joint : model_.joints) {
      if (!model_.tracks.contains(joint.name)) missing.insert(shown(joint.name));
    }
    if (!missing.empty()) {
      fmt::print(stderr, "warning: {}: no file gives the key frames {}: what they should move stands still\n", source_.name,
                 fmt::join(missing, ", "));
    }
    if (cones_ > 0) fmt::print(stderr, "warning: {}: {} cones are left out\n", source_.name, cones_);
  }

  const SourceFile& source_;
  Scene scene_;
  std::map<std::string, SourceFile> files_;
  AffModel model_;
  int cones_ = 0;
};

}  // namespace

Scene read_aff(const SourceFile& source) { return AffReader(source).read(); }

}  // namespace raystudy
