#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "harness/accel/pair_tree.h"

namespace raystudy::insertion {

/// k as a number of nodes: `percent` of all nodes, leaves counted, though only inner nodes are selected (the paper's "k = 1 % of
/// nodes"); rounded up, and at most all inner nodes.
inline std::size_t batch_size(double percent, std::size_t inner_nodes, std::size_t leaves) {
  const double share = std::ceil(percent / 100 * static_cast<double>(inner_nodes + leaves));
  return std::clamp<std::size_t>(static_cast<std::size_t>(share), 1, inner_nodes);
}

/// Chooses the inner nodes of a pass (Bittner 2015, Section 2.4).
class Selector {
 public:
  explicit Selector(std::uint64_t seed) : random_(seed) {}

  /// The k inner nodes of largest M_AREA(N) = m(N), in descending order: a partial sort. Measures are not negative, and such
  /// floats order as their bits do; equal ones go by record, so that the order is total.
  const std::vector<std::uint32_t>& by_area(const PairTree& tree, std::size_t k) {
    // Between passes the k-th largest measure hardly changes: keys well below the last one need not even be collected.
    collect(tree, floor_);
    if (keys_.size() < k) collect(tree, 0);
    const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(k);
    if (end != keys_.end()) std::nth_element(keys_.begin(), end, keys_.end(), std::greater<>());
    std::sort(keys_.begin(), end, std::greater<>());
    floor_ = 0.75F * std::bit_cast<float>(static_cast<std::uint32_t>(keys_[k - 1] >> 32U));
    selected_.clear();
    for (auto key = keys_.begin(); key != end; ++key) selected_.push_back(static_cast<std::uint32_t>(*key));
    return selected_;
  }

  /// k inner nodes at random, with repetition.
  const std::vector<std::uint32_t>& at_random(const PairTree& tree, std::size_t k) {
    selected_.clear();
    for (std::size_t i = 0; i < k; ++i) {
      // 32 random bits scaled to [0, inner_count): the same on every platform, unlike std::uniform_int_distribution.
      selected_.push_back(1 + static_cast<std::uint32_t>(((random_() >> 32U) * tree.inner_count()) >> 32U));
    }
    return selected_;
  }

 private:
  /// The inner nodes whose measure is not below `floor`, as (measure's bits, record) in one integer.
  void collect(const PairTree& tree, float floor) {
    keys_.clear();
    for (std::uint32_t p = 0; p < tree.pairs.size(); ++p) {
      const PairTree::Pair& pair = tree.pairs[p];
      for (std::uint32_t side = 0; side < (p == 0 ? 1U : 2U); ++side) {
        if (PairTree::is_leaf(pair.link[side]) || pair.measure[side] < floor) continue;
        keys_.push_back((std::uint64_t{std::bit_cast<std::uint32_t>(pair.measure[side])} << 32U) | pair.link[side]);
      }
    }
  }

  std::mt19937_64 random_;
  float floor_ = 0;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> selected_;
};

}  // namespace raystudy::insertion
