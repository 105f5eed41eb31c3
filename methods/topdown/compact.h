#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"

namespace raystudy::topdown {

/// Moves the nodes below `root` to `first` and behind, so that no slot among them stays unused; their order (depth first, left
/// before right) stays. They may begin at `first` already, but not before. Returns the end of theirs.
std::uint32_t close_gaps(AlignedVector<Bvh2Node>& nodes, std::uint32_t root, std::uint32_t first);

/// A node, and those below it: all slots in [first, end).
struct SubtreeBlock {
  std::uint32_t root = 0;
  std::uint32_t first = 0;
  std::uint32_t end = 0;
};

/// Moves a tree to memory of its own size, without the slots that larger leaves left unused; the order of nodes (depth first,
/// left before right) stays. `blocks` are subtrees without gaps, in any order, none within another; what is above them is small.
/// On the threads around the call.
void compact(Bvh2& bvh, std::vector<SubtreeBlock> blocks);

}  // namespace raystudy::topdown
