#include "methods/rotations/rotations.h"

#include <algorithm>

namespace raystudy::rotations {

void list_bottom_up(const PairTree& tree, std::vector<std::uint32_t>& order) {
  order.clear();
  std::vector<std::uint32_t> stack;
  const auto push = [&](std::uint32_t link) {
    if (!PairTree::is_leaf(link)) stack.push_back(link);
  };
  push(tree.root());
  while (!stack.empty()) {
    const std::uint32_t n = stack.back();
    stack.pop_back();
    order.push_back(n);
    push(tree.pairs[n].link[0]);
    push(tree.pairs[n].link[1]);
  }
  std::reverse(order.begin(), order.end());
}

}  // namespace raystudy::rotations
