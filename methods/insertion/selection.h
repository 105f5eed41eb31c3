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
  template <class Tree>
  const std::vector<std::uint32_t>& by_area(const Tree& tree, std::size_t k) {
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
  template <class Tree>
  const std::vector<std::uint32_t>& at_random(const Tree& tree, std::size_t k) {
    selected_.clear();
    for (std::size_t i = 0; i < k; ++i) selected_.push_back(random_inner(tree.inner_count()));
    return selected_;
  }

  /// k inner nodes with a probability that is nearly proportional to m(N): an independence chain with uniform proposals, accepted
  /// with the ratio of their measure to that of the last accepted one, and run on until another node is accepted (Bittner and
  /// Meister 2015, Section 5.2). The chain goes on from pass to pass; a pass sees the measures of its beginning. The root, which
  /// cannot be updated, is not proposed.
  template <class Tree>
  const std::vector<std::uint32_t>& by_metropolis_hastings(const Tree& tree, std::size_t k) {
    selected_.clear();
    const std::uint32_t count = tree.inner_count();
    if (count < 3) return at_random(tree, k);  // no two nodes to choose from
    list_measures(tree);
    std::uint64_t draw = 0;  // the upper half chooses, the lower half accepts
    const auto propose = [&] {
      std::uint32_t n = tree.root();
      while (n == tree.root()) {
        draw = random_();
        n = 1 + static_cast<std::uint32_t>(((draw >> 32U) * count) >> 32U);
      }
      return n;
    };
    if (accepted_ == 0 || accepted_ == tree.root()) accepted_ = propose();
    while (selected_.size() < k) {
      // Where nothing is left to prefer (measures of 0), uniform proposals do.
      const std::uint32_t n = propose();
      const float chance = static_cast<float>(draw & 0xffffffU) * 0x1p-24F;
      if (n == accepted_ || !(chance * measures_[accepted_] <= measures_[n])) continue;
      accepted_ = n;
      selected_.push_back(n);
    }
    return selected_;
  }

 private:
  /// 32 random bits scaled to [1, inner_count]: the same on every platform, unlike std::uniform_int_distribution.
  std::uint32_t random_inner(std::uint32_t inner_count) {
    return 1 + static_cast<std::uint32_t>(((random_() >> 32U) * inner_count) >> 32U);
  }

  /// m(N) by record: proposals are many, and 4 bytes each stay in the cache.
  template <class Tree>
  void list_measures(const Tree& tree) {
    measures_.resize(tree.pairs.size());
    for (std::uint32_t p = 0; p < tree.pairs.size(); ++p) {
      const auto& pair = tree.pairs[p];
      for (std::uint32_t side = 0; side < (p == 0 ? 1U : 2U); ++side) {
        if (!Tree::is_leaf(pair.link[side])) measures_[pair.link[side]] = pair.measure[side];
      }
    }
  }

  /// The inner nodes whose measure is not below `floor`, as (measure's bits, record) in one integer.
  template <class Tree>
  void collect(const Tree& tree, float floor) {
    keys_.clear();
    for (std::uint32_t p = 0; p < tree.pairs.size(); ++p) {
      const auto& pair = tree.pairs[p];
      for (std::uint32_t side = 0; side < (p == 0 ? 1U : 2U); ++side) {
        if (Tree::is_leaf(pair.link[side]) || pair.measure[side] < floor) continue;
        keys_.push_back((std::uint64_t{std::bit_cast<std::uint32_t>(pair.measure[side])} << 32U) | pair.link[side]);
      }
    }
  }

  std::mt19937_64 random_;
  float floor_ = 0;
  std::uint32_t accepted_ = 0;  ///< the last of the chain; 0: none yet
  std::vector<float> measures_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> selected_;
};

}  // namespace raystudy::insertion
