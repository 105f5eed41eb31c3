#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "methods/lbvh/order.h"

namespace raystudy::lbvh {

/// A tree's root, or that of a part of it: a node that is not in its place yet, since what is before it is not known.
struct Part {
  WideBox box;
  std::uint32_t first;  ///< as in Bvh2Node
  std::uint32_t count;
  std::uint32_t leaf;   ///< the last of its leaves, by number
  std::uint32_t place;  ///< behind the last of its triangles
  Gap gap;              ///< behind it
};

/// Places of whole leaves, which are built apart from the others.
struct Block {
  std::size_t begin = 0;
  std::size_t end = 0;
  std::uint32_t leaf = 0;  ///< the number of the first, or of none behind the last block: how many there are
};

/// Blocks that together are all places, and behind them an empty one.
[[nodiscard]] std::vector<Block> blocks_of(std::span<const Gap> gaps, int threads);

/// Makes the nodes below the roots of treelets and returns these roots in order; where there are no treelets, the one root of
/// all. `nodes` has room for two a leaf, which stand where README.md, 8, says.
///
/// Bottom-up as Apetrei 2014: a node is the first of two children if the gap before it is higher than the one behind, and the
/// second child to be done makes its parent. Leaves are taken in order. The second to be done is then always the second child,
/// and a stack holds the first ones that wait.
[[nodiscard]] std::vector<Part> build_parts(const Scene& scene, std::span<const std::uint32_t> order, const Gap* gaps,
                                            std::span<const Block> blocks, Bvh2Node* nodes);

}  // namespace raystudy::lbvh
