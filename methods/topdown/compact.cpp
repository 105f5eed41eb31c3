#include "methods/topdown/compact.h"

#include <algorithm>
#include <utility>

#include "harness/base/parallel.h"

namespace raystudy::topdown {

std::uint32_t close_gaps(AlignedVector<Bvh2Node>& nodes, std::uint32_t root, std::uint32_t first) {
  // Pairs are visited in the order of their slots, so that a pair only ever moves down, onto slots that were moved before.
  std::uint32_t next = first;
  std::vector<std::uint32_t> stack{root};
  while (!stack.empty()) {
    Bvh2Node& node = nodes[stack.back()];
    stack.pop_back();
    if (node.is_leaf()) continue;
    nodes[next] = nodes[node.first];
    nodes[next + 1] = nodes[node.first + 1];
    node.first = next;
    stack.push_back(next + 1);
    stack.push_back(next);
    next += 2;
  }
  return next;
}

namespace {

/// A node that goes to slot `to`, with its children, if it has any, at `children`.
struct Move {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::uint32_t children = 0;
};

Bvh2Node with_children_at(const Bvh2Node& node, std::uint32_t children) {
  Bvh2Node moved = node;
  if (!node.is_leaf()) moved.first = children;
  return moved;
}

/// The nodes above the blocks by themselves, the blocks' roots, and how many slots there will be.
struct Places {
  std::vector<Move> above;
  std::vector<Move> roots;
  std::uint32_t count = 2;
};

Places places(const AlignedVector<Bvh2Node>& nodes, const std::vector<SubtreeBlock>& blocks) {
  Places all;
  all.roots.resize(blocks.size());
  std::vector<Move> stack{{0, 0, 0}};
  while (!stack.empty()) {
    Move move = stack.back();
    stack.pop_back();
    move.children = all.count;
    const auto block = std::lower_bound(blocks.begin(), blocks.end(), move.from,
                                        [](const SubtreeBlock& b, std::uint32_t root) { return b.root < root; });
    if (block != blocks.end() && block->root == move.from) {
      all.roots[static_cast<std::size_t>(block - blocks.begin())] = move;
      all.count += block->end - block->first;
      continue;
    }
    all.above.push_back(move);
    const Bvh2Node& node = nodes[move.from];
    if (node.is_leaf()) continue;
    stack.push_back({node.first + 1, all.count + 1, 0});
    stack.push_back({node.first, all.count, 0});
    all.count += 2;
  }
  return all;
}

}  // namespace

void compact(Bvh2& bvh, std::vector<SubtreeBlock> blocks) {
  if (bvh.empty()) return;
  std::sort(blocks.begin(), blocks.end(), [](const SubtreeBlock& a, const SubtreeBlock& b) { return a.root < b.root; });
  const AlignedVector<Bvh2Node> from = std::move(bvh.nodes);
  const Places to = places(from, blocks);
  bvh.nodes = AlignedVector<Bvh2Node>(to.count, AlignedAllocator<Bvh2Node>::uninitialized());
  bvh.nodes[1] = {};
  for (const Move& move : to.above) bvh.nodes[move.to] = with_children_at(from[move.from], move.children);
  parallel_for_indices(blocks.size(), [&](std::size_t i) {
    const SubtreeBlock& block = blocks[i];
    const Move& root = to.roots[i];
    bvh.nodes[root.to] = with_children_at(from[root.from], root.children);
    const std::uint32_t shift = root.children - block.first;
    for (std::uint32_t n = block.first; n < block.end; ++n) {
      bvh.nodes[n + shift] = with_children_at(from[n], from[n].first + shift);
    }
  });
}

}  // namespace raystudy::topdown
