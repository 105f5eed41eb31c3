#pragma once

#include <cstdint>

#include "harness/vulkan/buffer.h"
#include "methods/topdown/top_down.h"

namespace raystudy::gpu {

struct SahParams {
  topdown::LeafPolicy leaves;
  std::uint32_t samples;      ///< candidates an axis
  std::uint32_t small_split;  ///< subtrees of no more triangles are built in one go; 0: none are
  std::uint32_t lbvh_levels;  ///< first levels that an LBVH makes; 0: none

  /// Most triangles of a leaf where the cost decides.
  [[nodiscard]] std::uint32_t max_leaf() const { return leaves.sah ? leaves.max_triangles : 0; }
  /// Between samples, in lengths of what they are spread over.
  [[nodiscard]] float spacing() const { return 1.0F / static_cast<float>(samples + 1); }
};

/// A node that is to be split, over the `count` triangles from `begin` on.
struct SahNode {
  std::uint32_t node;
  std::uint32_t begin;
  std::uint32_t count;
};

/// What all splits of a build work on.
struct SahMemory {
  vulkan::Slice boxes;     ///< of the triangles
  vulkan::Slice indices;   ///< of triangles, node by node
  vulkan::Slice nodes;     ///< children whose triangles part at place p of all are at 2p and 2p + 1
  vulkan::Slice scratch;   ///< triangles that go right; flags and their prefix sums
  vulkan::Slice sum_room;  ///< of prefix sums
};

}  // namespace raystudy::gpu
