#include "harness/accel/distinct_triangles.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace raystudy {
namespace {

/// The nodes depth first, so that what is under one is a range of places.
struct DepthFirst {
  std::vector<std::uint32_t> node;
  std::vector<std::uint32_t> parent;  ///< its place
  std::vector<std::uint32_t> end;     ///< the place after the last one under it

  explicit DepthFirst(const Bvh2& bvh) {
    struct Pending {
      std::uint32_t node;
      std::uint32_t parent;
    };
    std::vector<Pending> stack{{0, 0}};
    while (!stack.empty()) {
      const Pending next = stack.back();
      stack.pop_back();
      const auto place = static_cast<std::uint32_t>(node.size());
      node.push_back(next.node);
      parent.push_back(next.parent);
      end.push_back(place + 1);
      const Bvh2Node& n = bvh.nodes[next.node];
      if (n.is_leaf()) continue;
      stack.push_back({n.first + 1, place});
      stack.push_back({n.first, place});
    }
    for (std::size_t place = node.size(); place-- > 1;) end[parent[place]] = std::max(end[parent[place]], end[place]);
  }
};

/// Of each place, how many times two successive leaves of one triangle have it as their lowest common ancestor: so many more
/// references than triangles come together there (Tarjan 1979, lowest common ancestors off line).
std::vector<std::uint32_t> meetings(const Bvh2& bvh, const DepthFirst& order) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> met(order.node.size());
  std::vector<std::uint32_t> last(triangle_limit(bvh), none);
  std::vector<std::uint32_t> up = order.parent;
  for (std::uint32_t place = 0; place < order.node.size(); ++place) {
    const Bvh2Node& node = bvh.nodes[order.node[place]];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      std::uint32_t& before = last[bvh.triangles[i]];
      if (before != none) {
        std::uint32_t common = before;
        while (order.end[common] <= place) common = up[common];
        // What ends before this place ends before all later ones: the way is shorter from now on.
        for (std::uint32_t p = before; p != common;) {
          const std::uint32_t next = up[p];
          up[p] = common;
          p = next;
        }
        ++met[common];
      }
      before = place;
    }
  }
  return met;
}

}  // namespace

std::uint32_t triangle_limit(const Bvh2& bvh) {
  return bvh.triangles.empty() ? 0 : *std::max_element(bvh.triangles.begin(), bvh.triangles.end()) + 1;
}

std::vector<std::uint32_t> distinct_triangles(const Bvh2& bvh) {
  std::vector<std::uint32_t> counts(bvh.nodes.size());
  if (bvh.empty()) return counts;
  const DepthFirst order(bvh);
  const std::vector<std::uint32_t> met = bvh.duplicates ? meetings(bvh, order) : std::vector<std::uint32_t>(order.node.size());
  for (std::size_t place = order.node.size(); place-- > 0;) {
    const Bvh2Node& node = bvh.nodes[order.node[place]];
    const std::uint32_t references = node.is_leaf() ? node.count : counts[node.first] + counts[node.first + 1];
    counts[order.node[place]] = references - met[place];
  }
  return counts;
}

}  // namespace raystudy
