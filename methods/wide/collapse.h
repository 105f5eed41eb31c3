#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/base/parallel.h"
#include "harness/method/cost_model.h"

namespace raystudy::wide {

/// What a ray pays in a wide tree, in any unit.
struct CollapseCosts {
  float node = 1;      ///< each inner node it meets, with the test of all its boxes
  float leaf = 1;      ///< each leaf it meets
  float triangle = 0;  ///< each triangle of such a leaf
  std::uint32_t most_in_leaf = 8;
};

/// Which nodes of a binary tree become the children of which wide nodes, so that the expected cost
/// Σ_inner node · m(N) + Σ_leaf (leaf + triangle · t_N) · m(N) is the least of all wide trees that follow from the binary one by
/// leaving out inner nodes and by joining subtrees into leaves. Dynamic programming from the leaves up, over the number of
/// subtrees that a node leaves to the wide node above (Ylitie, Karras, Laine 2017, Sec. 3.2, Eq. 1 to 3).
template <int W>
class OptimalCollapse {
 public:
  static constexpr std::size_t width = W;

  /// `bvh` must outlive this. On the threads around the call where `threads` is not 1; the result is the same.
  template <class M>
  OptimalCollapse(const Bvh2& bvh, const M& measure, const CollapseCosts& costs, int threads = 1);

  /// The nodes that become the children of the wide node made of inner node `n`; returns how many they are, from 2 to W.
  std::uint32_t children(std::uint32_t n, std::array<std::uint32_t, width>& out) const;
  /// True where node `n`, as a child, is a leaf with all triangles of its subtree.
  [[nodiscard]] bool is_leaf(std::uint32_t n) const { return states_[n].leaf; }
  [[nodiscard]] float measure(std::uint32_t n) const { return states_[n].measure; }
  [[nodiscard]] std::uint32_t triangles(std::uint32_t n) const { return states_[n].triangles; }
  /// The least cost of the whole tree, times m(root).
  [[nodiscard]] double cost() const { return static_cast<double>(states_[0].best[0]); }

 private:
  /// best[i]: the least cost of a node's subtree as at most i + 1 children of the wide node above.
  struct State {
    std::array<float, width - 1> best;
    float measure;
    std::uint32_t triangles;
    bool leaf;
  };

  void solve(std::uint32_t n);
  std::uint32_t divide(std::uint32_t n, std::size_t parts, std::uint32_t* out) const;

  const Bvh2& bvh_;
  CollapseCosts costs_;
  std::unique_ptr<State[]> states_;  // NOLINT(modernize-avoid-c-arrays): left as it is until each is solved, by whichever thread
};

/// The indices of the nodes of `bvh`, or of the subtree at `root`, so that each stands after its children.
[[nodiscard]] std::vector<std::uint32_t> children_first(const Bvh2& bvh, std::uint32_t root = 0);
/// A tree cut into subtrees.
struct TreeCut {
  std::vector<std::uint32_t> above;  ///< inner nodes that are in no subtree, parents first
  std::vector<std::uint32_t> roots;
};
/// Level by level, until there are `subtrees` or more, or only leaves.
[[nodiscard]] TreeCut cut_into(const Bvh2& bvh, std::size_t subtrees);
/// True where every node stands before its children already, as builders leave them.
[[nodiscard]] bool is_parents_first(const Bvh2& bvh);

template <int W>
template <class M>
OptimalCollapse<W>::OptimalCollapse(const Bvh2& bvh, const M& measure, const CollapseCosts& costs, int threads)
    : bvh_(bvh),
      costs_(costs),
      states_(std::make_unique_for_overwrite<State[]>(bvh.nodes.size())) {  // NOLINT(modernize-avoid-c-arrays)
  const auto solve_measured = [&](std::uint32_t n) {
    states_[n].measure = measure(bvh.nodes[n].box);
    solve(n);
  };
  if (threads > 1 && !bvh.empty()) {
    const TreeCut cut = cut_into(bvh, std::size_t{64} * static_cast<std::size_t>(threads));
    parallel_for_indices(cut.roots.size(), [&](std::size_t i) {
      for (const std::uint32_t n : children_first(bvh, cut.roots[i])) solve_measured(n);
    });
    std::for_each(cut.above.rbegin(), cut.above.rend(), solve_measured);
  } else if (is_parents_first(bvh)) {
    for (auto n = static_cast<std::uint32_t>(bvh.nodes.size()); n-- > 0;) {
      if (n != 1) solve_measured(n);
    }
  } else {
    for (const std::uint32_t n : children_first(bvh)) solve_measured(n);
  }
}

}  // namespace raystudy::wide
