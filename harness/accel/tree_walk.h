#pragma once

#include <algorithm>
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

/// Calls visit(box, child) for every slot in use of every node; nodes depth first, wherever they lie, so that sums do not depend
/// on it. `child` as WideChild says.
template <class Visit>
void for_each_slot(const WideBvh& bvh, Visit&& visit) {
  if (bvh.empty()) return;
  bvh.visit([&visit](const auto& nodes) {
    std::vector<std::uint32_t> pending{0};
    while (!pending.empty()) {
      const auto& node = nodes[pending.back()];
      pending.pop_back();
      const auto used =
          static_cast<std::size_t>(std::find(node.child.begin(), node.child.end(), WideChild::none) - node.child.begin());
      for (std::size_t i = 0; i < used; ++i) visit(node.box(static_cast<int>(i)), node.child[i]);
      for (std::size_t i = used; i-- > 0;) {
        if (!WideChild::is_leaf(node.child[i])) pending.push_back(node.child[i]);
      }
    }
  });
}

/// Calls visit(node) for the root, then for both children of each inner node, inner nodes depth first: in the order in which
/// builders leave nodes, wherever they lie.
template <class Visit>
void for_each_pair(const Bvh2& bvh, Visit&& visit) {
  if (bvh.empty()) return;
  visit(bvh.nodes[0]);
  std::vector<std::uint32_t> pending{0};
  while (!pending.empty()) {
    const Bvh2Node& node = bvh.nodes[pending.back()];
    pending.pop_back();
    if (node.is_leaf()) continue;
    visit(bvh.nodes[node.first]);
    visit(bvh.nodes[node.first + 1]);
    pending.push_back(node.first + 1);
    pending.push_back(node.first);
  }
}

}  // namespace raystudy
