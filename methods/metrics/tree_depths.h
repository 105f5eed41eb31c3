#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"

namespace raystudy::metrics {

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

}  // namespace raystudy::metrics
