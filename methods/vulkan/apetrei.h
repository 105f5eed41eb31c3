#pragma once

#include <cstdint>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/lbvh_leaves.h"

namespace raystudy::gpu {

/// Where shaders/lbvh_apetrei.comp puts what it makes. With `least_depth` above 0 each treelet, parted from the next by a less
/// deep split, gets a tree of its own.
struct ApetreiOutput {
  vulkan::Slice nodes;  ///< of the splits within treelets; without treelets the root, too
  vulkan::Slice ends;   ///< a word a leaf for the kernel's own use
  std::uint32_t least_depth = 0;
  vulkan::Slice roots{};     ///< of the treelets
  vulkan::Slice treelets{};  ///< of each leaf
};

/// Records hierarchy and boxes from the leaves up, and a barrier.
void record_apetrei(vulkan::Device& device, vulkan::Commands& commands, const LbvhLeaves& leaves, const ApetreiOutput& output);

}  // namespace raystudy::gpu
