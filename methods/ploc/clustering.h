#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/base/aligned.h"
#include "harness/base/parallel.h"
#include "methods/ploc/clusters.h"
#include "methods/ploc/nearest.h"

namespace raystudy::ploc {

/// The tree as merging makes it: pairs of siblings in the order of rounds, the last first, so that parents stand before children.
/// Of a leaf `first` is its place in the order of triangles.
struct MergedTree {
  std::span<Bvh2Node> nodes;            ///< two a triangle; nodes[0] is the root, and nodes[1] not used
  AlignedRoom<std::uint32_t> leaves;    ///< by pair of siblings: how many leaves are below it
  std::vector<std::uint32_t> rounds{};  ///< after each, how many merges were made by then
};

/// Rounds of parallel locally-ordered clustering (Meister and Bittner 2018, Sec. 3, Alg. 1): every cluster finds its nearest
/// neighbour among those near it in Morton order, any two that are each other's are merged in the place of the first, and the
/// clusters that are left are moved together.
template <class M>
class Clustering {
 public:
  /// `clusters` are the leaves, one at least. `threads` are those of the calling thread's arena.
  Clustering(const Clusters& clusters, const M& measure, int radius, int threads, MergedTree& tree)
      : clusters_(clusters),
        measure_(measure),
        radius_(radius),
        threads_(threads),
        tree_(tree),
        most_(clusters.count()),
        nearest_(clusters.count() + search_group) {}

  void run() {
    while (clusters_.count() > 1) round();
    tree_.nodes[0] = node(0);
  }

 private:
  static constexpr std::size_t part = 1024;  ///< clusters that are written one after another

  /// How many clusters are left and how many merges were made, in a part or before it.
  struct Counts {
    std::uint32_t kept = 0;
    std::uint32_t merged = 0;
  };

  void round() {
    const std::size_t n = clusters_.count();
    const int threads = n < 4 * part ? 1 : threads_;
    parallel_for_blocks((n + search_group - 1) / search_group, 16, threads, [&](std::size_t begin, std::size_t end) {
      find_nearest(measure_, clusters_, begin * search_group, std::min(end * search_group, n), radius_, nearest_.data());
    });
    const std::size_t parts = (n + part - 1) / part;
    Counts sum{0, merges_};
    if (threads == 1) {
      for (std::size_t p = 0; p < parts; ++p) sum = write(p, sum, clusters_);
    } else {
      std::vector<Counts> starts(parts);
      parallel_for_indices(parts, [&](std::size_t p) { starts[p] = count(p); });
      for (Counts& start : starts) start = std::exchange(sum, Counts{sum.kept + start.kept, sum.merged + start.merged});
      if (!other_) other_.emplace(sum.kept, static_cast<std::size_t>(radius_));
      parallel_for_indices(parts, [&](std::size_t p) { write(p, starts[p], other_->clusters); });
      std::swap(clusters_, other_->clusters);
    }
    merges_ = sum.merged;
    tree_.rounds.push_back(merges_);
    clusters_.set_count(sum.kept);
  }

  /// The one that `i` is to be merged with; itself where the nearest has a nearer one.
  [[nodiscard]] std::uint32_t partner(std::uint32_t i) const {
    const std::uint32_t j = nearest_[i];
    return nearest_[j] == i ? j : i;
  }

  [[nodiscard]] std::uint32_t end_of(std::size_t p) const {
    return static_cast<std::uint32_t>(std::min((p + 1) * part, clusters_.count()));
  }

  [[nodiscard]] Counts count(std::size_t p) const {
    Counts counts;
    for (auto i = static_cast<std::uint32_t>(p * part); i < end_of(p); ++i) {
      const std::uint32_t j = partner(i);
      counts.kept += j >= i ? 1 : 0;
      counts.merged += j > i ? 1 : 0;
    }
    return counts;
  }

  /// Writes what is left of a part to its place; returns where the next part's begins. Which clusters merge cannot be predicted,
  /// so that they are listed without a branch first.
  Counts write(std::size_t p, Counts at, Clusters& to) {
    std::array<std::uint32_t, part> first;
    std::array<std::uint32_t, part> second;  // the same where the cluster stays alone
    std::array<std::uint32_t, part> merges;  // which of those
    std::uint32_t kept = 0;
    std::uint32_t merged = 0;
    for (auto i = static_cast<std::uint32_t>(p * part); i < end_of(p); ++i) {
      const std::uint32_t j = partner(i);
      first[kept] = i;
      second[kept] = j;
      merges[merged] = kept;
      kept += j >= i ? 1 : 0;
      merged += j > i ? 1 : 0;
    }
    for (std::uint32_t m = 0; m < merged; ++m) add_pair(at.merged + m, node(first[merges[m]]), node(second[merges[m]]));
    for (std::size_t r = 0; r < Clusters::rows; ++r) {
      const float* const bounds = clusters_.row(r);
      float* const united = to.row(r) + at.kept;
      for (std::uint32_t k = 0; k < kept; ++k) united[k] = min(bounds[first[k]], bounds[second[k]]);
    }
    for (std::uint32_t k = 0; k < kept; ++k) to.link(at.kept + k) = clusters_.link(first[k]);
    for (std::uint32_t m = 0; m < merged; ++m) to.link(at.kept + merges[m]) = pair_of(at.merged + m);
    return {at.kept + kept, at.merged + merged};
  }

  [[nodiscard]] Bvh2Node node(std::size_t i) const {
    const std::uint32_t link = clusters_.link(i);
    const bool leaf = (link & Clusters::leaf_bit) != 0;
    return {clusters_.box(i), link & ~Clusters::leaf_bit, leaf ? 1U : 0U};
  }

  /// Where the children of the `merge`-th merge of all stand.
  [[nodiscard]] std::uint32_t pair_of(std::uint32_t merge) const { return 2 * (static_cast<std::uint32_t>(most_) - 1 - merge); }

  void add_pair(std::uint32_t merge, const Bvh2Node& left, const Bvh2Node& right) {
    const auto leaf_count = [this](const Bvh2Node& n) { return n.is_leaf() ? 1 : tree_.leaves[n.first / 2]; };
    const std::uint32_t pair = pair_of(merge);
    tree_.nodes[pair] = left;
    tree_.nodes[pair + 1] = right;
    tree_.leaves[pair / 2] = leaf_count(left) + leaf_count(right);
  }

  /// What a round on several threads writes to: the parts of one room cannot be moved together at the same time.
  struct Other {
    Other(std::size_t most, std::size_t margin) : room(Clusters::room_for(most, margin)), clusters(most, margin, room) {}
    AlignedRoom<float> room;
    Clusters clusters;
  };

  Clusters clusters_;
  std::optional<Other> other_;
  const M& measure_;
  int radius_;
  int threads_;
  MergedTree& tree_;
  std::size_t most_;
  std::uint32_t merges_ = 0;
  AlignedRoom<std::uint32_t> nearest_;
};

}  // namespace raystudy::ploc
