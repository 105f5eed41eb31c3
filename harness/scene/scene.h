#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/shared_array.h"
#include "harness/geometry/box.h"
#include "harness/geometry/vec3.h"

namespace raystudy {

/// Three indices into Scene::vertices, in the file's own order.
struct Triangle {
  std::array<std::uint32_t, 3> vertex{};
  constexpr std::uint32_t operator[](int i) const { return vertex[static_cast<std::size_t>(i)]; }
  friend bool operator==(const Triangle&, const Triangle&) = default;
};
static_assert(sizeof(Triangle) == 12);

enum class MaterialKind : std::uint8_t { diffuse, reflective, refractive, emitter };

struct Material {
  std::string name;
  MaterialKind kind = MaterialKind::diffuse;
  Vec3 color{0.75F};           ///< albedo, mirror colour or transmittance, by kind; linear RGB
  Vec3 emission{0.0F};         ///< radiance of an emitter; linear RGB
  float refraction_index = 1;  ///< of a refractive material
};

/// A point light, or with `point_at_infinity` a directional one whose `position` is the direction towards it.
struct Light {
  std::string name;
  Vec3 position;
  Vec3 intensity{1.0F};
  bool point_at_infinity = false;
};

/// A pinhole camera.
struct Camera {
  std::string name;
  Vec3 eye;
  Vec3 target;
  Vec3 up{0, 1, 0};
  float vertical_fov = 60;  ///< degrees
};

/// Indexed triangles with the connectivity of their file, and what is needed to look at them. Immutable once loaded; cheap to
/// copy.
struct Scene {
  std::string name;
  std::string hash;  ///< 32 hex digits of XXH3-128 over the geometry and materials: the scene's identity in cell names
  SharedArray<Vec3> vertices;
  SharedArray<Triangle> triangles;
  SharedArray<std::uint32_t> triangle_materials;  ///< one a triangle into `materials`; empty: all are material 0
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<SharedArray<Vec3>> frames;  ///< vertex positions by frame, same topology; empty for a static scene
  Box bounds;

  [[nodiscard]] Box triangle_box(std::uint32_t t) const {
    Box box;
    for (int i = 0; i < 3; ++i) box.extend(vertices[triangles[t][i]]);
    return box;
  }
  [[nodiscard]] const Material& material_of(std::uint32_t t) const {
    return materials[triangle_materials.empty() ? 0 : triangle_materials[t]];
  }
  /// The named camera, or the first for an empty name. Throws Error with the nearest name.
  [[nodiscard]] const Camera& camera(std::string_view camera_name) const;
  /// Length of the diagonal of `bounds`, in scene units.
  [[nodiscard]] float diagonal() const { return length(bounds.extent()); }
};

/// Completes a scene whose arrays are filled: checks it (indices in range, finite vertices, one triangle at least, one material
/// entry a triangle), computes `bounds` and `hash`, and supplies a default material, a light and an overview camera where there
/// is none. Triangles of zero area are legal and kept. Throws Error that names `source` and what was found where.
void finish_scene(Scene& scene, std::string_view source);

}  // namespace raystudy
