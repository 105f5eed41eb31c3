#include "methods/updates/degradation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/base/parallel.h"

namespace raystudy::updates {
namespace {

/// Negative where there is none.
float area_ratio(const Bvh2& bvh, const Bvh2Node& node) {
  const float children = bvh.nodes[node.first].box.half_area() + bvh.nodes[node.first + 1].box.half_area();
  const float ratio = children > 0 ? node.box.half_area() / children : -1;
  return std::isfinite(ratio) ? ratio : -1;
}

}  // namespace

Degradation::Degradation(const Bvh2& bvh, int threads) : threads_(threads), ratios_(bvh.nodes.size() / 2, -1) {
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
    const Bvh2Node& node = bvh.nodes[n];
    if (n != 1 && !node.is_leaf()) ratios_[node.first / 2] = area_ratio(bvh, node);
  }
}

double Degradation::of(const Bvh2& bvh) const {
  if (bvh.inner_count() == 0) return 0;
  constexpr std::size_t block = 8192;  // nodes; sums of fixed blocks do not depend on the threads
  const std::size_t nodes = bvh.nodes.size();
  std::vector<double> sums((nodes + block - 1) / block);
  const auto add_up = [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t n = i * block; n < std::min(nodes, (i + 1) * block); ++n) {
        const Bvh2Node& node = bvh.nodes[n];
        if (n == 1 || node.is_leaf()) continue;
        const float before = ratios_[node.first / 2];
        const float now = area_ratio(bvh, node);
        if (before >= 0 && now >= 0) sums[i] += static_cast<double>(now) - static_cast<double>(before);
      }
    }
  };
  if (threads_ == 1) {
    add_up(0, sums.size());
  } else {
    with_threads(threads_, [&] { parallel_for_blocks(sums.size(), 1, add_up); });
  }
  return std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(bvh.inner_count());
}

}  // namespace raystudy::updates
