// glTF 2 and GLB by tinygltf: meshes placed by their nodes, skins and morph targets, the first animation as key frames; cameras,
// punctual lights, and materials as far as Material tells them apart.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "harness/base/parallel.h"
#include "harness/scene/gather.h"
#include "harness/scene/gltf_animation.h"
#include "harness/scene/gltf_model.h"
#include "harness/scene/gltf_shape.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

Vec3 vec3(const std::vector<double>& c, Vec3 otherwise) {
  if (c.size() < 3) return otherwise;
  return {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])};
}

double extension_number(const tinygltf::ExtensionMap& extensions, const std::string& extension, const std::string& key,
                        double otherwise) {
  const auto found = extensions.find(extension);
  if (found == extensions.end() || !found->second.IsObject() || !found->second.Has(key) || !found->second.Get(key).IsNumber()) {
    return otherwise;
  }
  return found->second.Get(key).GetNumberAsDouble();
}

/// Emitter: an emissive factor without a texture (which would say where). Refractive: KHR_materials_transmission. Reflective:
/// smooth metal.
Material converted(const tinygltf::Material& m) {
  const auto& pbr = m.pbrMetallicRoughness;
  Material material{.name = m.name, .color = vec3(pbr.baseColorFactor, Vec3{1})};
  const double strength = extension_number(m.extensions, "KHR_materials_emissive_strength", "emissiveStrength", 1);
  const Vec3 emission = vec3(m.emissiveFactor, Vec3{0}) * static_cast<float>(strength);
  if (!(emission == Vec3{0}) && m.emissiveTexture.index < 0) {
    material.kind = MaterialKind::emitter;
    material.emission = emission;
  } else if (extension_number(m.extensions, "KHR_materials_transmission", "transmissionFactor", 0) > 0) {
    material.kind = MaterialKind::refractive;
    material.refraction_index = static_cast<float>(extension_number(m.extensions, "KHR_materials_ior", "ior", 1.5));
  } else if (pbr.metallicFactor > 0.5 && pbr.roughnessFactor < 0.1 && pbr.metallicRoughnessTexture.index < 0) {
    material.kind = MaterialKind::reflective;
  }
  return material;
}

class GltfReader {
 public:
  explicit GltfReader(const SourceFile& source) : model_(source), animation_(model_), gather_{source.name} {}

  Scene read() {
    const tinygltf::Model& file = model_.file();
    for (const tinygltf::Material& m : file.materials) gather_.scene.materials.push_back(converted(m));
    default_material_ = static_cast<std::uint32_t>(gather_.scene.materials.size());
    gather_.scene.materials.push_back({.name = "default"});
    if (file.scenes.empty()) model_.fail("the file has no scene", "at least one");
    const int wanted = file.defaultScene < 0 ? 0 : file.defaultScene;
    for (const int node : model_.at(file.scenes, wanted, "scene").nodes) visit(node, -1, 0);
    const std::vector<double> times = animation_.frame_times();
    show(times.empty() ? 0 : times.front());
    move(times);
    return gather_.finished();
  }

 private:
  static constexpr int deepest = 1000;  // recursion must not run out of stack

  /// A node of the scene; parents come before their children.
  struct Visit {
    int node;
    int parent;
  };
  /// A primitive's vertices among all.
  struct Part {
    GltfShape shape;
    int node;
    std::size_t first;
  };

  void visit(int index, int parent, int depth) {
    const tinygltf::Node& node = model_.node(index);
    if (!visited_.insert(index).second) model_.fail(fmt::format("node {} is reached twice", index), "a tree of nodes");
    if (depth > deepest) model_.fail(fmt::format("the nodes are nested deeper than {}", deepest), "a flatter tree");
    visits_.push_back({index, parent});
    for (const int child : node.children) visit(child, index, depth + 1);
  }

  /// Poses of all nodes at a time of the animation, or as the file has them where it has none.
  [[nodiscard]] std::vector<GltfPose> poses_at(double time) const {
    std::vector<GltfPose> poses(model_.file().nodes.size());
    for (const Visit& v : visits_) poses[static_cast<std::size_t>(v.node)] = pose_of(model_, model_.node(v.node));
    animation_.apply(time, poses);
    return poses;
  }

  [[nodiscard]] std::vector<Affine> transforms_of(const std::vector<GltfPose>& poses) const {
    std::vector<Affine> transforms(poses.size());
    for (const Visit& v : visits_) {
      const auto node = static_cast<std::size_t>(v.node);
      transforms[node] = (v.parent < 0 ? Affine{} : transforms[static_cast<std::size_t>(v.parent)]) * poses[node].transform();
    }
    return transforms;
  }

  /// Everything that the nodes show at a time, in their order.
  void show(double time) {
    const tinygltf::Model& file = model_.file();
    const std::vector<GltfPose> poses = poses_at(time);
    const std::vector<Affine> transforms = transforms_of(poses);
    for (const Visit& v : visits_) {
      const tinygltf::Node& node = model_.node(v.node);
      const Affine& transform = transforms[static_cast<std::size_t>(v.node)];
      if (node.mesh >= 0) add_mesh(model_.at(file.meshes, node.mesh, "mesh"), v.node, poses, transforms);
      if (node.camera >= 0) add_camera(model_.at(file.cameras, node.camera, "camera"), node, transform);
      const double light = extension_number(node.extensions, "KHR_lights_punctual", "light", -1);
      if (light >= 0) add_light(model_.at(file.lights, static_cast<int>(light), "light"), transform);
    }
  }

  /// The key frames, where any vertex moves.
  void move(const std::vector<double>& times) {
    std::vector<std::vector<Vec3>> frames(times.size());
    parallel_for_each(frames.size(), [&](std::size_t f) {
      const std::vector<GltfPose> poses = poses_at(times[f]);
      const std::vector<Affine> transforms = transforms_of(poses);
      frames[f].resize(gather_.vertices.size());
      for (const Part& part : parts_) {
        part.shape.place(poses[static_cast<std::size_t>(part.node)].weights, transforms,
                         std::span(frames[f]).subspan(part.first, part.shape.size()));
      }
    });
    const bool moves = std::any_of(frames.begin(), frames.end(), [&](const auto& frame) { return frame != gather_.vertices; });
    if (!moves) return;
    for (auto& frame : frames) gather_.scene.frames.emplace_back(std::move(frame));
  }

  void add_camera(const tinygltf::Camera& c, const tinygltf::Node& node, const Affine& t) {
    if (c.type != "perspective") return;
    const Vec3 eye = t.point({});
    std::string name = !node.name.empty() ? node.name : c.name;
    if (name.empty()) name = fmt::format("camera-{}", gather_.scene.cameras.size() + 1);
    gather_.scene.cameras.push_back({.name = std::move(name),
                                     .eye = eye,
                                     .target = eye + t.vector({0, 0, -1}),
                                     .up = t.vector({0, 1, 0}),
                                     .vertical_fov = static_cast<float>(c.perspective.yfov * 180 / std::numbers::pi)});
  }

  void add_light(const tinygltf::Light& l, const Affine& t) {
    Light light{.name = l.name, .position = t.point({}), .intensity = vec3(l.color, Vec3{1}) * static_cast<float>(l.intensity)};
    if (l.type == "directional") {
      light.position = t.vector({0, 0, 1});
      light.point_at_infinity = true;
    }
    gather_.scene.lights.push_back(std::move(light));
  }

  void add_mesh(const tinygltf::Mesh& mesh, int node, const std::vector<GltfPose>& poses, const std::vector<Affine>& transforms) {
    // Primitives of a mesh that share positions and all that moves them share vertices: they may meet along an edge.
    std::map<std::pair<std::map<std::string, int>, std::vector<std::map<std::string, int>>>, std::size_t> shared;
    for (const tinygltf::Primitive& p : mesh.primitives) {
      const bool makes_triangles = p.mode == TINYGLTF_MODE_TRIANGLES || p.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                                   p.mode == TINYGLTF_MODE_TRIANGLE_FAN || p.mode == -1;
      if (!makes_triangles || !p.attributes.contains("POSITION")) continue;
      std::map<std::string, int> moving;
      for (const auto& [name, accessor] : p.attributes) {
        if (name == "POSITION" || name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) moving[name] = accessor;
      }
      const auto [part, added] = shared.try_emplace({std::move(moving), p.targets}, parts_.size());
      if (added) add_part(GltfShape(model_, node, p), node, poses, transforms);
      const Part& vertices = parts_[part->second];
      const auto count = static_cast<std::uint32_t>(vertices.shape.size());
      const std::uint32_t material = p.material < 0 ? default_material_ : static_cast<std::uint32_t>(p.material);
      gather_.add_triangles(triangles_of(p, count), static_cast<std::uint32_t>(vertices.first), count, material);
    }
  }

  void add_part(GltfShape shape, int node, const std::vector<GltfPose>& poses, const std::vector<Affine>& transforms) {
    for (const int joint : shape.joints()) {
      if (!visited_.contains(joint)) {
        model_.fail(fmt::format("joint node {} is not in the scene", joint), "a node below its roots");
      }
    }
    std::vector<Vec3> positions(shape.size());
    shape.place(poses[static_cast<std::size_t>(node)].weights, transforms, positions);
    parts_.push_back({std::move(shape), node, gather_.add_vertices(positions)});
  }

  [[nodiscard]] std::vector<Triangle> triangles_of(const tinygltf::Primitive& p, std::uint32_t vertex_count) const {
    std::vector<std::uint32_t> corners;
    if (p.indices >= 0) {
      corners = model_.integers(p.indices, TINYGLTF_TYPE_SCALAR);
    } else {
      for (std::uint32_t v = 0; v < vertex_count; ++v) corners.push_back(v);
    }
    std::vector<Triangle> triangles;
    const bool list = p.mode == TINYGLTF_MODE_TRIANGLES || p.mode == -1;
    const std::size_t step = list ? 3 : 1;
    for (std::size_t i = 0; i + 2 < corners.size(); i += step) {
      if (p.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        triangles.push_back({{corners[0], corners[i + 1], corners[i + 2]}});
      } else if (!list && i % 2 == 1) {
        triangles.push_back({{corners[i + 1], corners[i], corners[i + 2]}});  // every other of a strip is turned
      } else {
        triangles.push_back({{corners[i], corners[i + 1], corners[i + 2]}});
      }
    }
    return triangles;
  }

  GltfModel model_;
  GltfAnimation animation_;
  Gather gather_;
  std::uint32_t default_material_ = 0;
  std::set<int> visited_;
  std::vector<Visit> visits_;
  std::vector<Part> parts_;
};

}  // namespace

Scene read_gltf(const SourceFile& source) { return GltfReader(source).read(); }

}  // namespace raystudy
