#include "harness/accel/pair_tree.h"

#include <utility>

namespace raystudy {

PairTree::PairTree(const Bvh2& bvh) : pairs(bvh.nodes.size() / 2), up(pairs.size()) {
  leaves.reserve(pairs.size());
  struct Task {
    std::uint32_t source;  // in bvh.nodes
    std::uint32_t slot;
  };
  std::vector<Task> stack{{0, 0}};
  std::uint32_t next = 1;
  pairs[0].boxes = BoxPair::twice(bvh.nodes[0].box);
  while (!stack.empty()) {
    const auto [source, slot] = stack.back();
    stack.pop_back();
    const Bvh2Node& node = bvh.nodes[source];
    Node copy{BoxPair::twice(node.box), 0, 0};
    if (node.is_leaf()) {
      copy.link = leaf_bit | static_cast<std::uint32_t>(leaves.size());
      leaves.push_back({node.first, node.count});
    } else {
      copy.link = next++;
      stack.push_back({node.first + 1, 2 * copy.link + 1});
      stack.push_back({node.first, 2 * copy.link});
    }
    put(slot, copy);
  }
}

void PairTree::write_to(Bvh2& bvh) const {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(bvh.triangles.size());
  struct Task {
    std::uint32_t slot;
    std::uint32_t target;  // in bvh.nodes
  };
  std::vector<Task> stack{{0, 0}};
  std::uint32_t next = 2;
  while (!stack.empty()) {
    const auto [slot, target] = stack.back();
    stack.pop_back();
    const Pair& pair = pairs[slot / 2];
    const std::uint32_t link = pair.link[slot % 2];
    Bvh2Node& node = bvh.nodes[target];
    node.box = pair.boxes.box(slot % 2);
    if (is_leaf(link)) {
      const Leaf leaf = leaves[link & ~leaf_bit];
      node.first = static_cast<std::uint32_t>(triangles.size());
      node.count = leaf.count;
      for (std::uint32_t i = 0; i < leaf.count; ++i) triangles.push_back(bvh.triangles[leaf.first + i]);
    } else {
      node.first = next;
      node.count = 0;
      next += 2;
      const bool second_is_larger = pairs[link].measure[1] > pairs[link].measure[0];
      for (const std::uint32_t below : pairs[link].link) {
        if (!is_leaf(below)) __builtin_prefetch(&pairs[below]);
      }
      const std::uint32_t larger = second_is_larger ? 1 : 0;
      stack.push_back({2 * link + 1 - larger, node.first + 1 - larger});
      stack.push_back({2 * link + larger, node.first + larger});
    }
  }
  bvh.triangles = std::move(triangles);
}

}  // namespace raystudy
