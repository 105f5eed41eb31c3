#include "harness/accel/tree_height.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace raystudy {

std::size_t tree_height(const Bvh2& bvh) {
  if (bvh.empty()) return 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> pending{{0, 0}};
  std::size_t height = 0;
  while (!pending.empty()) {
    const auto [index, depth] = pending.back();
    pending.pop_back();
    height = std::max(height, depth);
    const Bvh2Node& node = bvh.nodes[index];
    if (node.is_leaf()) continue;
    pending.emplace_back(node.first, depth + 1);
    pending.emplace_back(node.first + 1, depth + 1);
  }
  return height;
}

}  // namespace raystudy
