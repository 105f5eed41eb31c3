#include "methods/wide/collapse.h"

#include <algorithm>
#include <limits>

#include "harness/geometry/vec3.h"

namespace raystudy::wide {

bool is_parents_first(const Bvh2& bvh) {
  for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n) {
    if (n != 1 && !bvh.nodes[n].is_leaf() && bvh.nodes[n].first <= n) return false;
  }
  return true;
}

std::vector<std::uint32_t> children_first(const Bvh2& bvh, std::uint32_t root) {
  std::vector<std::uint32_t> order;
  if (bvh.empty()) return order;
  if (root == 0) order.reserve(bvh.nodes.size() - 1);
  order.push_back(root);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Bvh2Node& node = bvh.nodes[order[i]];
    if (node.is_leaf()) continue;
    order.push_back(node.first);
    order.push_back(node.first + 1);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

TreeCut cut_into(const Bvh2& bvh, std::size_t subtrees) {
  TreeCut cut;
  cut.roots.push_back(0);
  std::vector<std::uint32_t> level;
  for (std::size_t before = 0; cut.roots.size() != before && cut.roots.size() < subtrees;) {
    before = cut.roots.size();
    level.swap(cut.roots);
    cut.roots.clear();
    for (const std::uint32_t n : level) {
      const Bvh2Node& node = bvh.nodes[n];
      if (node.is_leaf()) {
        cut.roots.push_back(n);
      } else {
        cut.above.push_back(n);
        cut.roots.push_back(node.first);
        cut.roots.push_back(node.first + 1);
      }
    }
  }
  return cut;
}

template <int W>
void OptimalCollapse<W>::solve(std::uint32_t n) {
  const Bvh2Node& node = bvh_.nodes[n];
  State& state = states_[n];
  if (node.is_leaf()) {
    state.triangles = node.count;
    state.leaf = true;
    state.best.fill(state.measure * (costs_.leaf + costs_.triangle * static_cast<float>(node.count)));
    return;
  }
  const State& left = states_[node.first];
  const State& right = states_[node.first + 1];
  state.triangles = left.triangles + right.triangles;
  // divided[j]: as j + 2 parts, i + 1 of them from the left and the rest from the right. `right` stands behind a row of
  // infinities, so that every i has a term for every j and the inner loop is one vector operation.
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::array<float, 3 * width> shifted;
  shifted.fill(infinity);
  std::copy(right.best.begin(), right.best.end(), shifted.begin() + width);
  std::array<float, width> divided;
  divided.fill(infinity);
  for (std::size_t i = 0; i + 1 < width; ++i) {
    const float* from = shifted.data() + width - i;
    for (std::size_t j = 0; j < width; ++j) divided[j] = min(divided[j], left.best[i] + from[j]);
  }
  const float as_node = state.measure * costs_.node + divided[width - 2];
  const float as_leaf = state.measure * (costs_.leaf + costs_.triangle * static_cast<float>(state.triangles));
  state.leaf = state.triangles <= costs_.most_in_leaf && as_leaf <= as_node;
  state.best[0] = state.leaf ? as_leaf : as_node;
  for (std::size_t i = 1; i + 1 < width; ++i) state.best[i] = min(divided[i - 1], state.best[i - 1]);
}

template <int W>
std::uint32_t OptimalCollapse<W>::divide(std::uint32_t n, std::size_t parts, std::uint32_t* out) const {
  const std::uint32_t first = bvh_.nodes[n].first;
  const State& left = states_[first];
  const State& right = states_[first + 1];
  std::size_t best = 1;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 1; i < parts; ++i) {
    const float cost = left.best[i - 1] + right.best[parts - i - 1];
    if (!(cost < least)) continue;
    least = cost;
    best = i;
  }
  std::uint32_t count = 0;
  const auto expand = [&](std::uint32_t child, std::size_t most) {
    const auto& costs = states_[child].best;
    while (most > 1 && !(costs[most - 1] < costs[most - 2])) --most;
    if (most == 1) {
      out[count++] = child;
    } else {
      count += divide(child, most, out + count);
    }
  };
  expand(first, best);
  expand(first + 1, parts - best);
  return count;
}

template <int W>
std::uint32_t OptimalCollapse<W>::children(std::uint32_t n, std::array<std::uint32_t, width>& out) const {
  return divide(n, width, out.data());
}

template class OptimalCollapse<4>;
template class OptimalCollapse<8>;
template class OptimalCollapse<16>;

}  // namespace raystudy::wide
