#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/method/pair_measure.h"

namespace raystudy::insertion {

/// The best places for nodes that still stand in the tree: the bottom-up search of Meister and Bittner 2018, and its extension to
/// both children of a node, which leave it together as in Bittner, Hapala and Havran 2013. Changes nothing in the tree, so that
/// any number of these may search it at the same time.
///
/// `M` is SurfaceArea or AnyMeasure; it must not decrease when a box grows. The tree is measured.
template <class M>
class BottomUpSearch {
 public:
  using Node = PairTree::Node;
  using Pair = PairTree::Pair;

  /// A gain must exceed this share of what leaving frees: less may be rounding.
  static constexpr float least_gain = 1e-5F;

  struct Place {
    float gain = 0;  ///< by how much Σ_inner m(N) falls
    std::uint32_t slot = 0;
  };

  struct Places {
    float freed = 0;                      ///< by how much Σ_inner m(N) falls when both children leave
    float cost = 0;                       ///< by how much it rises at most when both are inserted
    std::array<std::uint32_t, 2> slot{};  ///< where each is inserted: as the sibling of what stands there
  };

  /// `tree` and `measure` must outlive this.
  BottomUpSearch(const PairTree& tree, const M& measure) : tree_(tree), measure_(measure), stack_(64) { shrunk_.reserve(32); }

  /// Where the node at `slot`, which is not the root, gains most as the sibling of another: exactly the best place of all, as if
  /// the node had been taken out and every other place been tried. Gain 0 where it stands best.
  [[nodiscard]] Place of_node(std::uint32_t slot) {
    const Node x = tree_.node(slot);
    std::uint32_t at = tree_.up[slot / 2];  // where the sibling will stand
    float freed = measure_at(at);
    Best best{-least_gain * freed, slot};
    BoxPair rest = tree_.pairs[slot / 2].boxes.doubled((slot ^ 1U) % 2);  // of the ancestor that stands at `at`, without x
    try_below(x, slot ^ 1U, -freed, best);
    bool shrinks = true;
    while (at >= 2) {
      const std::uint32_t next = tree_.up[at / 2];
      try_at(x, at ^ 1U, -freed, best);
      const float measure = measure_at(next);
      if (shrinks) {
        rest = united(rest, tree_.pairs[at / 2].boxes.doubled((at ^ 1U) % 2));
        const float shrunk = measure_both(measure_, rest)[0];
        shrinks = shrunk < measure;
        freed += measure - shrunk;
      }
      // As the sibling of this ancestor, x makes it as large as it was.
      if (measure - freed < best.cost) best = {measure - freed, next};
      at = next;
    }
    return best.slot == slot ? Place{} : Place{-best.cost, best.slot};
  }

  /// The best places for both children of inner node `n`, which is not the root, once they have left it and n's parent with it.
  /// Each is found without the other; what both enlarge is counted twice.
  [[nodiscard]] Places of_children(std::uint32_t n) {
    const std::uint32_t slot = tree_.up[n];
    const std::uint32_t parent_slot = tree_.up[slot / 2];
    Places places;
    places.freed = measure_at(slot) + measure_at(parent_slot);
    shrunk_.clear();
    BoxPair rest = tree_.pairs[slot / 2].boxes.doubled((slot ^ 1U) % 2);
    for (std::uint32_t at = parent_slot; at >= 2;) {
      rest = united(rest, tree_.pairs[at / 2].boxes.doubled((at ^ 1U) % 2));
      at = tree_.up[at / 2];
      const float shrunk = measure_both(measure_, rest)[0];
      const float measure = measure_at(at);
      if (!(shrunk < measure)) break;
      places.freed += measure - shrunk;
      shrunk_.push_back({rest, shrunk, 0, at});
    }
    for (std::uint32_t side = 0; side < 2; ++side) {
      const Best best = place(tree_.node(2 * n + side), slot ^ 1U, parent_slot);
      places.slot[side] = best.slot;
      places.cost += best.cost;
    }
    return places;
  }

 private:
  struct Best {
    float cost;
    std::uint32_t slot;
  };
  /// A record not yet visited, and the cost of getting there: what the nodes above it are enlarged by.
  struct Entry {
    float induced;
    std::uint32_t record;
  };
  /// An ancestor that becomes smaller when both children leave.
  struct Shrunk {
    BoxPair box;
    float measure;
    float induced;  ///< what this and the smaller ancestors above are enlarged by
    std::uint32_t slot;
  };

  [[nodiscard]] float measure_at(std::uint32_t slot) const { return tree_.pairs[slot / 2].measure[slot % 2]; }
  /// The measure of the union of x and the node at `slot`.
  [[nodiscard]] float merged_measure(const Node& x, std::uint32_t slot) const {
    const Float4 merged = measure_both(measure_, united(tree_.pairs[slot / 2].boxes, x.box));
    return slot % 2 == 0 ? merged[0] : merged[1];
  }

  /// Tries x beside the node at `slot` and everywhere below it; `induced` is what the nodes above are enlarged by.
  void try_at(const Node& x, std::uint32_t slot, float induced, Best& best) {
    const float total = induced + merged_measure(x, slot);
    if (total < best.cost) best = {total, slot};
    descend(x, slot, total, best);
  }
  void try_below(const Node& x, std::uint32_t slot, float induced, Best& best) {
    descend(x, slot, induced + merged_measure(x, slot), best);
  }
  /// Below the node at `slot`, beside which x would cost `total`.
  void descend(const Node& x, std::uint32_t slot, float total, Best& best) {
    const Pair& pair = tree_.pairs[slot / 2];
    const float induced = total - pair.measure[slot % 2];
    const std::uint32_t link = pair.link[slot % 2];
    if (!PairTree::is_leaf(link) && induced + x.measure < best.cost) visit_all(x, {induced, link}, best);
  }

  /// Depth first from a record, the more promising child first.
  void visit_all(const Node& x, Entry entry, Best& best) {
    for (std::size_t waiting = 0;;) {
      const Pair& pair = tree_.pairs[entry.record];
      const Float4 merged = measure_both(measure_, united(pair.boxes, x.box));
      std::array<Entry, 2> below{};
      for (std::uint32_t side = 0; side < 2; ++side) {
        const float total = entry.induced + merged[side];
        if (total < best.cost) best = {total, 2 * entry.record + side};
        below[side] = {total - pair.measure[side], pair.link[side]};
      }
      if (below[1].induced < below[0].induced) std::swap(below[0], below[1]);
      const auto leads_on = [&](const Entry& e) { return !PairTree::is_leaf(e.record) && e.induced + x.measure < best.cost; };
      if (leads_on(below[1])) {
        __builtin_prefetch(&tree_.pairs[below[1].record]);
        if (waiting == stack_.size()) stack_.resize(2 * waiting);
        stack_[waiting++] = below[1];
      }
      if (leads_on(below[0])) {
        entry = below[0];
        continue;
      }
      do {
        if (waiting == 0) return;
        entry = stack_[--waiting];
      } while (!(entry.induced + x.measure < best.cost));
    }
  }

  /// The least cost of inserting x where n and its parent are gone: n's sibling, now at `sibling`, will stand at `at`, and the
  /// ancestors in `shrunk_` are smaller.
  Best place(const Node& x, std::uint32_t sibling, std::uint32_t at) {
    float induced = 0;
    for (std::size_t i = shrunk_.size(); i-- > 0;) {
      induced += measure_both(measure_, united(shrunk_[i].box, x.box))[0] - shrunk_[i].measure;
      shrunk_[i].induced = induced;
    }
    Best best{induced + merged_measure(x, sibling), at};
    descend(x, sibling, best.cost, best);
    for (const Shrunk& ancestor : shrunk_) {
      try_at(x, at ^ 1U, ancestor.induced, best);
      at = ancestor.slot;
      // Beside the ancestor: x enlarges it as before, but as their new parent.
      const float total = ancestor.induced + ancestor.measure;
      if (total < best.cost) best = {total, at};
    }
    while (at >= 2) {
      const std::uint32_t next = tree_.up[at / 2];
      try_at(x, at ^ 1U, 0, best);
      at = next;
      if (measure_at(at) < best.cost) best = {measure_at(at), at};
    }
    return best;
  }

  const PairTree& tree_;
  const M& measure_;
  std::vector<Entry> stack_;
  std::vector<Shrunk> shrunk_;
};

}  // namespace raystudy::insertion
