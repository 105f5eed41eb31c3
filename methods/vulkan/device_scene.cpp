#include "methods/vulkan/device_scene.h"

namespace raystudy::gpu {

static_assert(sizeof(Vec3) == 12 && sizeof(Triangle) == 12);

DeviceScene::DeviceScene(vulkan::Device& device, const Scene& scene)
    : arena_(device, vulkan::Arena::bytes_for({scene.vertices.size() * sizeof(Vec3), scene.triangles.size() * sizeof(Triangle)})),
      triangle_count_(static_cast<std::uint32_t>(scene.triangles.size())),
      vertices_(arena_.take(scene.vertices.size() * sizeof(Vec3))),
      triangles_(arena_.take(scene.triangles.size() * sizeof(Triangle))),
      upload_seconds_(
          vulkan::upload(device, vertices_, std::span<const Vec3>(scene.vertices.data(), scene.vertices.size())) +
          vulkan::upload(device, triangles_, std::span<const Triangle>(scene.triangles.data(), scene.triangles.size()))) {}

}  // namespace raystudy::gpu
