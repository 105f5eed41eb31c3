#pragma once

#include <cstdint>

#include "harness/scene/scene.h"
#include "harness/vulkan/buffer.h"

namespace raystudy::gpu {

/// A scene's vertices (three floats) and triangles (three indices) on a device.
class DeviceScene {
 public:
  /// Throws Error where the device's memory is too small.
  DeviceScene(vulkan::Device& device, const Scene& scene);

  [[nodiscard]] std::uint32_t triangle_count() const { return triangle_count_; }
  [[nodiscard]] const vulkan::Slice& vertices() const { return vertices_; }
  [[nodiscard]] const vulkan::Slice& triangles() const { return triangles_; }
  [[nodiscard]] double upload_seconds() const { return upload_seconds_; }

 private:
  vulkan::Arena arena_;
  std::uint32_t triangle_count_;
  vulkan::Slice vertices_;
  vulkan::Slice triangles_;
  double upload_seconds_;
};

}  // namespace raystudy::gpu
