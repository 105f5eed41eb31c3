#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"

namespace raystudy {

/// Calls visit(node, depth) for every node of the tree, the root at depth 0; without recursion, as trees may be very deep.
template <class Visit>
void for_each_node(const Bvh2& bvh, Visit&& visit) {
  if (bvh.empty()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pending{{0, 0}};
  while (!pending.empty()) {
    const auto [index, depth] = pending.back();
    pending.pop_back();
    const Bvh2Node& node = bvh.nodes[index];
    visit(node, depth);
    if (node.is_leaf()) continue;
    pending.emplace_back(node.first + 1, depth + 1);
    pending.emplace_back(node.first, depth + 1);
  }
}

/// Calls visit(box, child) for every slot in use of every node, in the nodes' order; `child` as WideChild says.
template <class Visit>
void for_each_slot(const WideBvh& bvh, Visit&& visit) {
  bvh.visit([&visit](const auto& nodes) {
    for (const auto& node : nodes) {
      for (int i = 0; i < node.width && node.child[static_cast<std::size_t>(i)] != WideChild::none; ++i) {
        visit(node.box(i), node.child[static_cast<std::size_t>(i)]);
      }
    }
  });
}

}  // namespace raystudy
