// glTF 2 and GLB by tinygltf: meshes placed by their nodes, cameras, punctual lights, materials as far as Material tells them
// apart.
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <numbers>
#include <set>

#include "harness/scene/gather.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

/// An affine map: three columns and an origin, in double like the file's own matrices.
struct Affine {
  std::array<std::array<double, 3>, 4> column{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};

  [[nodiscard]] Vec3 apply(Vec3 p, double w) const {
    std::array<double, 3> out{};
    for (std::size_t k = 0; k < 3; ++k) {
      out[k] = column[0][k] * static_cast<double>(p.x) + column[1][k] * static_cast<double>(p.y) +
               column[2][k] * static_cast<double>(p.z) + column[3][k] * w;
    }
    return {static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2])};
  }
  [[nodiscard]] Vec3 point(Vec3 p) const { return apply(p, 1); }
  [[nodiscard]] Vec3 vector(Vec3 v) const { return apply(v, 0); }
};

Affine operator*(const Affine& a, const Affine& b) {
  Affine product;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      product.column[c][k] = a.column[0][k] * b.column[c][0] + a.column[1][k] * b.column[c][1] + a.column[2][k] * b.column[c][2] +
                             (c == 3 ? a.column[3][k] : 0);
    }
  }
  return product;
}

Affine transform_of(const tinygltf::Node& node) {
  Affine t;
  if (node.matrix.size() == 16) {
    for (std::size_t c = 0; c < 4; ++c) {
      std::copy_n(node.matrix.begin() + static_cast<std::ptrdiff_t>(4 * c), 3, t.column[c].begin());
    }
    return t;
  }
  if (node.rotation.size() == 4) {
    const double x = node.rotation[0];
    const double y = node.rotation[1];
    const double z = node.rotation[2];
    const double w = node.rotation[3];
    t.column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)};
    t.column[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
    t.column[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
  }
  for (std::size_t c = 0; c < 3 && node.scale.size() == 3; ++c) {
    for (double& k : t.column[c]) k *= node.scale[c];
  }
  if (node.translation.size() == 3) std::copy_n(node.translation.begin(), 3, t.column[3].begin());
  return t;
}

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

/// The file callbacks tinygltf wants, over SourceFile::sibling.
tinygltf::FsCallbacks callbacks(const SourceFile& source) {
  tinygltf::FsCallbacks fs{};
  fs.FileExists = [](const std::string& file, void* data) {
    return static_cast<const SourceFile*>(data)->sibling(file).has_value();
  };
  fs.ExpandFilePath = [](const std::string& file, void* /*data*/) { return file; };
  fs.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& file, void* data) {
    const auto bytes = static_cast<const SourceFile*>(data)->sibling(file);
    if (!bytes) {
      *error += "there is no " + file;
      return false;
    }
    out->assign(bytes->begin(), bytes->end());
    return true;
  };
  fs.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
  fs.user_data = const_cast<SourceFile*>(&source);  // NOLINT: the interface is C's; nothing is changed
  return fs;
}

class GltfReader {
 public:
  explicit GltfReader(const SourceFile& source) : source_(source), gather_{source.name} {}

  Scene read() {
    parse();
    for (const std::string& extension : model_.extensionsRequired) {
      if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression") {
        fail(fmt::format("the file needs the extension {}", extension), "uncompressed meshes");
      }
    }
    for (const tinygltf::Material& m : model_.materials) gather_.scene.materials.push_back(converted(m));
    default_material_ = static_cast<std::uint32_t>(gather_.scene.materials.size());
    gather_.scene.materials.push_back({.name = "default"});
    if (model_.scenes.empty()) fail("the file has no scene", "at least one");
    const int wanted = model_.defaultScene < 0 ? 0 : model_.defaultScene;
    for (const int node : at(model_.scenes, wanted, "scene").nodes) add_node(node, {}, 0);
    return gather_.finished();
  }

 private:
  static constexpr int deepest = 1000;  // recursion must not run out of stack

  [[noreturn]] void fail(std::string message, std::string expected = {}) const {
    fail_at(source_.name, std::move(message), std::move(expected));
  }

  template <class T>
  [[nodiscard]] const T& at(const std::vector<T>& list, int index, std::string_view what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
      fail(fmt::format("the file refers to {} {}", what, index), fmt::format("an index below {}", list.size()));
    }
    return list[static_cast<std::size_t>(index)];
  }

  void parse() {
    tinygltf::TinyGLTF loader;
    // Images are not needed, and decoding them would only be another way to fail.
    loader.SetImageLoader(
        [](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; },
        nullptr);
    loader.SetFsCallbacks(callbacks(source_));
    std::string error;
    std::string warning;
    const auto size = static_cast<unsigned>(source_.bytes.size());
    bool good = false;
    try {
      good = as_text(source_.bytes).starts_with("glTF")
                 ? loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                               reinterpret_cast<const unsigned char*>(source_.bytes.data()), size)
                 : loader.LoadASCIIFromString(&model_, &error, &warning, source_.bytes.data(), size, "");
    } catch (const std::exception& thrown) {
      error = thrown.what();
    }
    if (good) return;
    while (error.ends_with('\n')) error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    fail(fmt::format("tinygltf cannot read the file: {}", error));
  }

  void add_node(int index, const Affine& parent, int depth) {
    const tinygltf::Node& node = at(model_.nodes, index, "node");
    if (!visited_.insert(index).second) fail(fmt::format("node {} is reached twice", index), "a tree of nodes");
    if (depth > deepest) fail(fmt::format("the nodes are nested deeper than {}", deepest), "a flatter tree");
    const Affine transform = parent * transform_of(node);
    if (node.mesh >= 0) add_mesh(at(model_.meshes, node.mesh, "mesh"), transform);
    if (node.camera >= 0) add_camera(at(model_.cameras, node.camera, "camera"), node, transform);
    const double light = extension_number(node.extensions, "KHR_lights_punctual", "light", -1);
    if (light >= 0) add_light(at(model_.lights, static_cast<int>(light), "light"), transform);
    for (const int child : node.children) add_node(child, transform, depth + 1);
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

  void add_mesh(const tinygltf::Mesh& mesh, const Affine& t) {
    std::map<int, std::pair<std::uint32_t, std::uint32_t>> shared;  // accessor: first vertex and count
    for (const tinygltf::Primitive& p : mesh.primitives) {
      const bool makes_triangles = p.mode == TINYGLTF_MODE_TRIANGLES || p.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                                   p.mode == TINYGLTF_MODE_TRIANGLE_FAN || p.mode == -1;
      const auto position = p.attributes.find("POSITION");
      if (!makes_triangles || position == p.attributes.end()) continue;
      // Primitives of a mesh that share their positions share vertices: they may meet along an edge.
      auto [vertices, added] = shared.try_emplace(position->second);
      if (added) {
        std::vector<Vec3> positions = read_positions(position->second);
        for (Vec3& v : positions) v = t.point(v);
        vertices->second = {gather_.add_vertices(positions), static_cast<std::uint32_t>(positions.size())};
      }
      const auto [base, count] = vertices->second;
      const std::uint32_t material = p.material < 0 ? default_material_ : static_cast<std::uint32_t>(p.material);
      gather_.add_triangles(triangles_of(p, count), base, count, material);
    }
  }

  [[nodiscard]] std::vector<Triangle> triangles_of(const tinygltf::Primitive& p, std::uint32_t vertex_count) const {
    std::vector<std::uint32_t> corners;
    if (p.indices >= 0) {
      corners = read_indices(p.indices);
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

  struct View {
    const unsigned char* data;
    std::size_t stride;
    std::size_t count;
    int component;
    bool normalized;
  };

  /// An accessor's elements, all of them inside their buffer.
  [[nodiscard]] View view(int index, int type) const {
    const tinygltf::Accessor& a = at(model_.accessors, index, "accessor");
    if (a.sparse.isSparse) fail(fmt::format("accessor {} is sparse", index), "a dense accessor");
    if (a.type != type) {
      fail(fmt::format("accessor {} has the wrong type", index), type == TINYGLTF_TYPE_VEC3 ? "VEC3" : "SCALAR");
    }
    const tinygltf::BufferView& v = at(model_.bufferViews, a.bufferView, "buffer view");
    const tinygltf::Buffer& b = at(model_.buffers, v.buffer, "buffer");
    const int component_bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(a.componentType));
    if (component_bytes <= 0) fail(fmt::format("accessor {} has component type {}", index, a.componentType), "5120 to 5126");
    const std::size_t element = static_cast<std::size_t>(component_bytes) * (type == TINYGLTF_TYPE_VEC3 ? 3 : 1);
    const std::size_t stride = v.byteStride == 0 ? element : v.byteStride;
    const std::size_t size = b.data.size();
    const bool fits = v.byteOffset <= size && v.byteLength <= size - v.byteOffset && a.byteOffset <= v.byteLength &&
                      (a.count == 0 || (element <= v.byteLength - a.byteOffset &&
                                        a.count - 1 <= (v.byteLength - a.byteOffset - element) / stride));
    if (!fits) {
      fail(fmt::format("accessor {} with {} elements reaches past its buffer of {} bytes", index, a.count, size),
           "a complete file");
    }
    return {b.data.data() + v.byteOffset + a.byteOffset, stride, a.count, a.componentType, a.normalized};
  }

  template <class T>
  static T load(const unsigned char* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
  }

  /// One component; integer ones as KHR_mesh_quantization says.
  float component(const View& v, const unsigned char* p, std::size_t k) const {
    const auto scaled = [&v](float value, float most) { return v.normalized ? std::max(value / most, -1.0F) : value; };
    switch (v.component) {
      case TINYGLTF_COMPONENT_TYPE_FLOAT: return load<float>(p + 4 * k);
      case TINYGLTF_COMPONENT_TYPE_BYTE: return scaled(load<std::int8_t>(p + k), 127);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return scaled(load<std::uint8_t>(p + k), 255);
      case TINYGLTF_COMPONENT_TYPE_SHORT: return scaled(load<std::int16_t>(p + 2 * k), 32767);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return scaled(load<std::uint16_t>(p + 2 * k), 65535);
      default: fail(fmt::format("positions have component type {}", v.component), "float, or 8 or 16 bit integers");
    }
  }

  [[nodiscard]] std::vector<Vec3> read_positions(int accessor) const {
    const View v = view(accessor, TINYGLTF_TYPE_VEC3);
    std::vector<Vec3> positions(v.count);
    for (std::size_t i = 0; i < v.count; ++i) {
      const unsigned char* p = v.data + i * v.stride;
      positions[i] = {component(v, p, 0), component(v, p, 1), component(v, p, 2)};
    }
    return positions;
  }

  [[nodiscard]] std::vector<std::uint32_t> read_indices(int accessor) const {
    const View v = view(accessor, TINYGLTF_TYPE_SCALAR);
    std::vector<std::uint32_t> indices(v.count);
    for (std::size_t i = 0; i < v.count; ++i) {
      const unsigned char* p = v.data + i * v.stride;
      switch (v.component) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: indices[i] = load<std::uint8_t>(p); break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: indices[i] = load<std::uint16_t>(p); break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: indices[i] = load<std::uint32_t>(p); break;
        default: fail(fmt::format("indices have component type {}", v.component), "unsigned integers");
      }
    }
    return indices;
  }

  const SourceFile& source_;
  tinygltf::Model model_;
  Gather gather_;
  std::uint32_t default_material_ = 0;
  std::set<int> visited_;
};

}  // namespace

Scene read_gltf(const SourceFile& source) { return GltfReader(source).read(); }

}  // namespace raystudy
