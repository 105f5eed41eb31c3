#include "harness/report/clusters.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raystudy {
namespace {

/// Triangles below every node, leaf by leaf; children may stand anywhere behind or before their parents.
std::vector<std::uint32_t> triangle_counts(const Bvh2& bvh) {
  std::vector<std::uint32_t> order{0};
  std::size_t next = 0;
  while (next < order.size()) {
    const Bvh2Node& node = bvh.nodes[order[next++]];
    if (!node.is_leaf()) order.insert(order.end(), {node.first, node.first + 1});
  }
  std::vector<std::uint32_t> counts(bvh.nodes.size());
  std::reverse(order.begin(), order.end());  // children before parents
  for (const std::uint32_t n : order) {
    const Bvh2Node& node = bvh.nodes[n];
    counts[n] = node.is_leaf() ? node.count : counts[node.first] + counts[node.first + 1];
  }
  return counts;
}

}  // namespace

std::vector<std::uint32_t> clusters_of(const Bvh2& bvh, std::uint32_t triangles) {
  if (bvh.empty()) return {};
  const std::vector<std::uint32_t> counts = triangle_counts(bvh);
  struct Pending {
    std::uint32_t node;
    bool in_cluster;  ///< of the number last given
  };
  std::vector<std::uint32_t> clusters(*std::max_element(bvh.triangles.begin(), bvh.triangles.end()) + std::size_t{1});
  std::uint32_t next = 0;
  std::vector<Pending> pending{{0, false}};
  while (!pending.empty()) {
    Pending at = pending.back();
    pending.pop_back();
    const Bvh2Node& node = bvh.nodes[at.node];
    if (!at.in_cluster && (node.is_leaf() || counts[at.node] < triangles)) {
      ++next;
      at.in_cluster = true;
    }
    if (node.is_leaf()) {
      for (std::uint32_t i = 0; i < node.count; ++i) clusters[bvh.triangles[node.first + i]] = next - 1;
    } else {
      pending.push_back({node.first + 1, at.in_cluster});
      pending.push_back({node.first, at.in_cluster});
    }
  }
  return clusters;
}

Vec3 cluster_color(std::uint32_t cluster) {
  constexpr double golden_section = 0.6180339887498949;
  const auto hue = static_cast<float>(std::fmod(golden_section * cluster, 1.0));
  const auto channel = [hue](float shift) {
    const float h = std::fmod(hue + shift, 1.0F) * 6;
    return 0.08F + 0.72F * std::clamp(std::fabs(h - 3) - 1, 0.0F, 1.0F);
  };
  return {channel(0), channel(2.0F / 3), channel(1.0F / 3)};
}

Scene colored_by_cluster(const Scene& frame, const std::vector<std::uint32_t>& clusters) {
  Scene colored = frame;
  colored.materials.clear();
  const std::uint32_t count = clusters.empty() ? 0 : *std::max_element(clusters.begin(), clusters.end()) + 1;
  for (std::uint32_t c = 0; c < count; ++c) colored.materials.push_back({.name = "cluster", .color = cluster_color(c)});
  colored.triangle_materials = SharedArray<std::uint32_t>(clusters);
  return colored;
}

}  // namespace raystudy
