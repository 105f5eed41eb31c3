#include "harness/scene/scene.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstddef>
#include <memory>

#include "harness/base/error.h"

namespace raystudy {
namespace {

// Trees have up to 2 · triangles node slots, indexed by 32 bits.
constexpr std::size_t triangle_limit = std::size_t{1} << 31U;

void require(bool good, std::string_view source, std::string message, std::string expected) {
  if (!good) throw Error(Diagnostic{{std::string(source), 0, 0}, std::move(message), std::move(expected), {}});
}

void check_arrays(const Scene& scene, std::string_view source) {
  require(!scene.triangles.empty(), source, "the scene has no triangles", "at least one");
  require(scene.triangles.size() < triangle_limit, source, fmt::format("{} triangles", scene.triangles.size()),
          "fewer than 2^31");
  for (std::size_t i = 0; i < scene.vertices.size(); ++i) {
    const Vec3 v = scene.vertices[i];
    if (!is_finite(v)) require(false, source, fmt::format("vertex {} is ({}, {}, {})", i, v.x, v.y, v.z), "finite coordinates");
  }
  for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
    for (int i = 0; i < 3; ++i) {
      if (scene.triangles[t][i] >= scene.vertices.size()) {
        require(false, source, fmt::format("triangle {} refers to vertex {}", t, scene.triangles[t][i]),
                fmt::format("an index below {}", scene.vertices.size()));
      }
    }
  }
  require(scene.triangle_materials.empty() || scene.triangle_materials.size() == scene.triangles.size(), source,
          fmt::format("{} material indices for {} triangles", scene.triangle_materials.size(), scene.triangles.size()),
          "one a triangle");
  for (std::size_t t = 0; t < scene.triangle_materials.size(); ++t) {
    if (scene.triangle_materials[t] >= scene.materials.size()) {
      require(false, source, fmt::format("triangle {} refers to material {}", t, scene.triangle_materials[t]),
              fmt::format("an index below {}", scene.materials.size()));
    }
  }
  for (std::size_t f = 0; f < scene.frames.size(); ++f) {
    require(scene.frames[f].size() == scene.vertices.size(), source,
            fmt::format("frame {} has {} vertices", f, scene.frames[f].size()), fmt::format("{}", scene.vertices.size()));
    for (std::size_t i = 0; i < scene.frames[f].size(); ++i) {
      const Vec3 v = scene.frames[f][i];
      if (!is_finite(v)) {
        require(false, source, fmt::format("vertex {} of frame {} is ({}, {}, {})", i, f, v.x, v.y, v.z), "finite coordinates");
      }
    }
  }
}

std::string content_hash(const Scene& scene) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_128bits_reset(state.get());
  const auto update = [&state](const void* data, std::size_t bytes) {
    const std::uint64_t size = bytes;  // lengths are hashed too: arrays must not run into each other
    XXH3_128bits_update(state.get(), &size, sizeof size);
    XXH3_128bits_update(state.get(), data, bytes);
  };
  update(scene.vertices.data(), scene.vertices.size() * sizeof(Vec3));
  update(scene.triangles.data(), scene.triangles.size() * sizeof(Triangle));
  update(scene.triangle_materials.data(), scene.triangle_materials.size() * sizeof(std::uint32_t));
  for (const auto& frame : scene.frames) update(frame.data(), frame.size() * sizeof(Vec3));
  for (const Material& m : scene.materials) {
    const auto kind = static_cast<std::uint8_t>(m.kind);
    update(&kind, sizeof kind);
    update(&m.color, sizeof m.color);
    update(&m.emission, sizeof m.emission);
    update(&m.refraction_index, sizeof m.refraction_index);
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

const Camera& Scene::camera(std::string_view camera_name) const {
  std::vector<std::string> known;
  for (const Camera& camera : cameras) {
    if (camera_name.empty() || camera.name == camera_name) return camera;
    known.push_back(camera.name);
  }
  throw Error(Diagnostic{{},
                         fmt::format("scene '{}' has no camera '{}'", name, camera_name),
                         known.empty() ? "a scene with cameras" : fmt::format("one of {}", fmt::join(known, ", ")),
                         nearest_name(camera_name, known)});
}

void finish_scene(Scene& scene, std::string_view source) {
  if (scene.materials.empty()) scene.materials.push_back({.name = "default"});
  check_arrays(scene, source);
  scene.bounds = {};
  for (const Triangle& triangle : scene.triangles) {
    for (int i = 0; i < 3; ++i) scene.bounds.extend(scene.vertices[triangle[i]]);
  }
  const Vec3 center = scene.bounds.center();
  const float size = max(scene.diagonal(), 1e-6F);
  if (scene.cameras.empty()) {
    scene.cameras.push_back(
        {.name = "overview", .eye = center + Vec3{0.6F, 0.45F, 0.8F} * size, .target = center, .vertical_fov = 50});
  }
  if (scene.lights.empty()) {
    scene.lights.push_back({.name = "sun", .position = {0.4F, 0.8F, 0.45F}, .intensity = Vec3{1}, .point_at_infinity = true});
  }
  scene.hash = content_hash(scene);
}

}  // namespace raystudy
