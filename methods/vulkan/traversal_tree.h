#pragma once

#include <cstdint>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"
#include "harness/vulkan/buffer.h"

namespace raystudy::gpu {

/// A tree on a device in the form that rays traverse (shaders/traversal.glsl): pairs of siblings of 64 bytes in the places they
/// have in Bvh2::nodes, and triangles of 40 bytes in the order of the leaves. The device makes it from nodes, triangles and
/// vertices, which it holds only meanwhile.
class TraversalTree {
 public:
  /// The tree is not empty. Throws Error where the device's memory is too small or the tree has 2^31 - 1 triangles or more.
  TraversalTree(vulkan::Device& device, const Bvh2& bvh, const Scene& scene);

  [[nodiscard]] const vulkan::Slice& pairs() const { return pairs_; }
  [[nodiscard]] const vulkan::Slice& triangles() const { return triangles_; }
  /// As traversal.glsl refers to nodes.
  [[nodiscard]] std::uint32_t root() const { return root_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// Levels below the root.
  [[nodiscard]] std::uint32_t height() const { return height_; }

 private:
  vulkan::Arena arena_;
  vulkan::Slice pairs_;
  vulkan::Slice triangles_;
  std::uint32_t root_;
  Box bounds_;
  std::uint32_t height_;
};

}  // namespace raystudy::gpu
