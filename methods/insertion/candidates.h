#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/base/parallel.h"

namespace raystudy::insertion {

/// What may be taken out of a tree and put in elsewhere: a node, or both children of an inner node.
class Candidate {
 public:
  Candidate() = default;
  [[nodiscard]] static Candidate node_at(std::uint32_t slot) { return Candidate(slot); }
  [[nodiscard]] static Candidate children_of(std::uint32_t inner) { return Candidate(inner | children_bit); }
  [[nodiscard]] static Candidate from_id(std::uint32_t id) { return Candidate(id); }

  [[nodiscard]] bool is_node() const { return (id_ & children_bit) == 0; }
  /// Where the node stands; of a node only.
  [[nodiscard]] std::uint32_t slot() const { return id_; }
  /// The record that it stands in, or that both children do.
  [[nodiscard]] std::uint32_t record() const { return is_node() ? id_ / 2 : id_ & ~children_bit; }
  [[nodiscard]] std::uint32_t id() const { return id_; }

 private:
  static constexpr std::uint32_t children_bit = 0x80000000U;
  explicit Candidate(std::uint32_t id) : id_(id) {}
  std::uint32_t id_ = 0;
};

/// Which candidates have something new about them since they were last looked at: their record has got another node or box.
class Activity {
 public:
  explicit Activity(const PairTree& tree) : tree_(tree), flags_(tree.pairs.size(), everything), listed_(tree.pairs.size(), 0) {}

  /// Record `p` has got another node or another box.
  void changed(std::uint32_t p) {
    if (p == 0) return;
    raise(p, everything);
    for (const std::uint32_t link : tree_.pairs[p].link) {
      if (!PairTree::is_leaf(link)) raise(link, children);
    }
  }
  void raise(Candidate c) { raise(c.record(), flag_of(c)); }
  void settle(Candidate c) { flags_[c.record()] &= static_cast<std::uint8_t>(~flag_of(c)); }
  [[nodiscard]] bool is_active(Candidate c) const { return (flags_[c.record()] & flag_of(c)) != 0; }

  /// Takes the records that have been raised since the last call.
  void take_raised(std::vector<std::uint32_t>& records) {
    records.clear();
    records.swap(raised_);
    for (const std::uint32_t p : records) listed_[p] = 0;
  }

 private:
  static constexpr std::uint8_t children = 4;
  static constexpr std::uint8_t everything = 7;
  static std::uint8_t flag_of(Candidate c) { return c.is_node() ? static_cast<std::uint8_t>(1U << (c.slot() % 2)) : children; }

  void raise(std::uint32_t p, std::uint8_t flags) {
    flags_[p] |= flags;
    if (listed_[p] != 0) return;
    listed_[p] = 1;
    raised_.push_back(p);
  }

  const PairTree& tree_;
  std::vector<std::uint8_t> flags_;   ///< by record: bit 0 and 1 for the nodes in it, bit 2 for both together
  std::vector<std::uint8_t> listed_;  ///< by record: whether it is in raised_
  std::vector<std::uint32_t> raised_;
};

enum class Ranking : std::uint8_t { potential, area, none };

/// Chooses candidates and puts them in order, the most promising first.
class Candidates {
 public:
  /// Measures of `tree` are ranked as they stand when a list is made; it must outlive this.
  Candidates(const PairTree& tree, Ranking ranking, bool with_children)
      : tree_(tree), ranking_(ranking), with_children_(with_children) {
    count_ranks();
  }

  /// From now on, only those at least as promising as the first `share` of each kind (0 to 1) were when this was made, to within
  /// a 128th.
  void limit_to(double share) {
    for (std::size_t kind = 0; kind < 2; ++kind) floor_[kind] = floor_of(counts_[kind], share);
  }

  /// All that `filter(Candidate)` lets through.
  template <class Filter>
  [[nodiscard]] const std::vector<Candidate>& all(const Filter& filter) {
    constexpr std::size_t block = 4096;
    std::vector<std::vector<std::uint64_t>> parts((tree_.pairs.size() + block - 1) / block);
    parallel_for_indices(parts.size(), [&](std::size_t i) {
      const std::size_t end = std::min((i + 1) * block, tree_.pairs.size());
      for (std::size_t p = std::max<std::size_t>(1, i * block); p < end; ++p) {
        collect(static_cast<std::uint32_t>(p), filter, parts[i]);
      }
    });
    keys_.clear();
    for (const auto& part : parts) keys_.insert(keys_.end(), part.begin(), part.end());
    return sorted();
  }

  /// Those of some records.
  template <class Filter>
  [[nodiscard]] const std::vector<Candidate>& in(const std::vector<std::uint32_t>& records, const Filter& filter) {
    keys_.clear();
    for (const std::uint32_t p : records) collect(p, filter, keys_);
    return sorted();
  }

 private:
  // Ranks are not negative, and such floats order as their bits do; the upper half of the bits has 128 steps an octave.
  static constexpr int bin_shift = 16;
  using Bins = std::vector<std::uint32_t>;

  /// f(candidate, rank) for the nodes of a record and for both together. Ranks are not negative. That of Ranking::potential is
  /// the most that its reinsertion could gain from its parents alone, for wherever a node x goes, it gets a parent of m(x) at
  /// least.
  template <class F>
  void for_each_of(std::uint32_t p, const F& f) const {
    const std::array<float, 2>& own = tree_.pairs[p].measure;
    const std::uint32_t up = tree_.up[p];
    const float parent = tree_.pairs[up / 2].measure[up % 2];
    for (std::uint32_t side = 0; side < 2; ++side) {
      f(Candidate::node_at(2 * p + side), ranked(std::max(0.0F, parent - own[side]), own[side]));
    }
    if (!with_children_ || p == tree_.root()) return;
    const std::uint32_t grand = tree_.up[up / 2];
    const float grandparent = tree_.pairs[grand / 2].measure[grand % 2];
    f(Candidate::children_of(p), ranked(std::max(0.0F, grandparent - own[0]) + std::max(0.0F, parent - own[1]), parent));
  }

  [[nodiscard]] float ranked(float potential, float area) const {
    switch (ranking_) {
      case Ranking::potential: return potential;
      case Ranking::area: return area;
      case Ranking::none: break;
    }
    return 0;
  }

  void count_ranks() {
    for (Bins& bins : counts_) bins.assign(std::size_t{1} << (31 - bin_shift), 0);
    for (std::uint32_t p = 1; p < tree_.pairs.size(); ++p) {
      for_each_of(
          p, [&](Candidate c, float rank) { ++counts_[c.is_node() ? 0 : 1][std::bit_cast<std::uint32_t>(rank) >> bin_shift]; });
    }
  }

  static float floor_of(const Bins& bins, double share) {
    std::size_t total = 0;
    for (const std::uint32_t count : bins) total += count;
    const double wanted = share * static_cast<double>(total);
    std::size_t bin = bins.size() - 1;
    for (std::size_t sum = bins[bin]; bin > 0 && static_cast<double>(sum) < wanted; sum += bins[bin]) --bin;
    return std::bit_cast<float>(static_cast<std::uint32_t>(bin) << bin_shift);
  }

  template <class Filter>
  void collect(std::uint32_t p, const Filter& filter, std::vector<std::uint64_t>& keys) const {
    for_each_of(p, [&](Candidate c, float rank) {
      if (!(rank >= floor_[c.is_node() ? 0 : 1]) || !filter(c)) return;
      keys.push_back((std::uint64_t{std::bit_cast<std::uint32_t>(rank)} << 32U) | c.id());
    });
  }

  const std::vector<Candidate>& sorted() {
    std::sort(keys_.begin(), keys_.end(), std::greater<>());
    list_.clear();
    for (const std::uint64_t key : keys_) list_.push_back(Candidate::from_id(static_cast<std::uint32_t>(key)));
    return list_;
  }

  const PairTree& tree_;
  Ranking ranking_;
  bool with_children_;
  std::array<Bins, 2> counts_;
  std::array<float, 2> floor_{};
  std::vector<std::uint64_t> keys_;
  std::vector<Candidate> list_;
};

}  // namespace raystudy::insertion
