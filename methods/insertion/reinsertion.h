#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "harness/accel/pair_tree.h"
#include "harness/method/pair_measure.h"
#include "methods/insertion/min_heap.h"

namespace raystudy::insertion {

/// The tree operations of Bittner, Hapala and Havran: removal, branch-and-bound search, reinsertion (Bittner 2015, Section 2.3).
/// Keeps every inner node's box the exact union of its children's, and the sum of inner measures up to date.
///
/// `M` is SurfaceArea or AnyMeasure; it must not decrease when a box grows.
template <class M>
class Reinsertion {
 public:
  using Node = PairTree::Node;
  using Pair = PairTree::Pair;

  /// Where a node may be merged in, and what that costs: C(L, X) = C_D(L, X) + C_I(L, X).
  struct Place {
    std::uint32_t slot = 0;
    float cost = std::numeric_limits<float>::infinity();
  };

  /// What removing an inner node leaves: the nodes to insert again, the larger first, and the two records that are free now.
  struct Removed {
    std::array<Node, 2> nodes;
    std::array<std::uint32_t, 2> free{};
    std::uint32_t old_slot = 0;  ///< where the sibling of the removed node now stands
  };

  /// `tree` is measured here; it and `measure` must outlive this.
  Reinsertion(PairTree& tree, const M& measure) : tree_(tree), measure_(measure) {
    measure_all(tree_, measure_);
    inner_sum_ = inner_measure_sum(tree_);
  }

  /// Σ_inner m(N), kept as the tree changes.
  [[nodiscard]] double inner_sum() const { return inner_sum_; }
  [[nodiscard]] float measure_of(std::uint32_t inner) const {
    const std::uint32_t slot = tree_.up[inner];
    return tree_.pairs[slot / 2].measure[slot % 2];
  }

  /// Takes out inner node `n` and its parent, so that n's sibling stands in the parent's place (Fig. 3). `n` is not the root.
  Removed remove(std::uint32_t n) {
    const std::uint32_t slot = tree_.up[n];
    const std::uint32_t parent = slot / 2;
    const std::uint32_t parent_slot = tree_.up[parent];
    Removed removed{{tree_.node(2 * n), tree_.node(2 * n + 1)}, {n, parent}, parent_slot};
    if (removed.nodes[1].measure > removed.nodes[0].measure) std::swap(removed.nodes[0], removed.nodes[1]);
    inner_sum_ -= static_cast<double>(measure_of(n));
    inner_sum_ -= static_cast<double>(measure_of(parent));
    tree_.put(parent_slot, tree_.node(slot ^ 1U));
    refit_up(parent_slot / 2);
    return removed;
  }

  /// Takes out one child of `n` only: its other child stands in n's place, and record n is free.
  struct RemovedOne {
    Node node;
    std::uint32_t free = 0;
    std::uint32_t old_slot = 0;
  };
  RemovedOne remove_child(std::uint32_t n, std::uint32_t side) {
    const std::uint32_t slot = tree_.up[n];
    const RemovedOne removed{tree_.node(2 * n + side), n, slot};
    inner_sum_ -= static_cast<double>(measure_of(n));
    tree_.put(slot, tree_.node((2 * n + side) ^ 1U));
    refit_up(slot / 2);
    return removed;
  }

  /// The slot where merging `l` enlarges the tree least: Algorithm 1, exactly, for any `hint`. The cost of merging at `hint` only
  /// spares the search what cannot be better.
  [[nodiscard]] Place search(const Node& l, std::uint32_t hint) {
    // The hint's cost is summed upwards, the search's downwards: the margin covers their different rounding, so that the search
    // itself finds the hint again where nothing is better.
    Place best{hint, merge_cost(l, hint) * 1.0001F + std::numeric_limits<float>::min()};
    const float own = l.measure;
    heap_.clear();
    // `next` is the least entry of all that is left; it goes through the heap only where another comes before it.
    for (Entry next = visit_root(l, best); next != none;) {
      const float induced = key(next);
      if (!(induced + own < best.cost)) break;  // the least lower bound of all that is left
      const std::uint32_t p = record(next);
      const Pair& pair = tree_.pairs[p];
      const Float4 merged = measure_both(measure_, united(pair.boxes, l.box));
      std::array<Entry, 2> below{none, none};
      for (std::uint32_t side = 0; side < 2; ++side) {
        const float total = induced + merged[side];
        if (total < best.cost) best = {2 * p + side, total};
      }
      for (std::uint32_t side = 0; side < 2; ++side) {
        const float induced_below = induced + (merged[side] - pair.measure[side]);
        if (PairTree::is_leaf(pair.link[side]) || !(induced_below + own < best.cost)) continue;
        below[side] = entry(induced_below, pair.link[side]);
        __builtin_prefetch(&tree_.pairs[pair.link[side]]);
      }
      next = least_of(below);
    }
    return best;
  }

  /// Merges `l` with what stands at `slot`, under record `free` as their parent (Fig. 5).
  void insert(const Node& l, std::uint32_t slot, std::uint32_t free) {
    const Node x = tree_.node(slot);
    tree_.put(2 * free, x);
    tree_.put(2 * free + 1, l);
    Node parent{united(x.box, l.box), free, 0};
    parent.measure = measure_both(measure_, parent.box)[0];
    inner_sum_ += static_cast<double>(parent.measure);
    tree_.put(slot, parent);
    grow_up(slot / 2, l.box);
  }

  /// Fetches what an update of `n` touches first: in two steps, for the second needs what the first fetched.
  void prefetch_soon(std::uint32_t n) const {
    __builtin_prefetch(&tree_.up[n]);
    __builtin_prefetch(&tree_.pairs[n]);
  }
  void prefetch_next(std::uint32_t n) const {
    const std::uint32_t parent = tree_.up[n] / 2;
    __builtin_prefetch(&tree_.pairs[parent]);
    __builtin_prefetch(&tree_.up[parent]);
  }

  /// Updates inner node `n`, not the root, as the paper does: both children are taken out and inserted again, the larger first.
  void update_both(std::uint32_t n) {
    const Removed removed = remove(n);
    for (std::size_t i = 0; i < 2; ++i) {
      insert(removed.nodes[i], search(removed.nodes[i], removed.old_slot).slot, removed.free[i]);
    }
  }

  /// The variant that removes one child, the larger; the tree cannot become worse, for the child's old place stays open to it.
  void update_larger(std::uint32_t n) {
    const auto& measures = tree_.pairs[n].measure;
    const RemovedOne removed = remove_child(n, measures[1] > measures[0] ? 1 : 0);
    insert(removed.node, search(removed.node, removed.old_slot).slot, removed.free);
  }

  /// C(L, X) of merging `l` with the node at `slot`.
  [[nodiscard]] float merge_cost(const Node& l, std::uint32_t slot) const {
    float cost = measure_both(measure_, united(tree_.node(slot).box, l.box))[0];
    for (std::uint32_t p = slot / 2; p != 0; p = slot / 2) {
      slot = tree_.up[p];
      const Node ancestor = tree_.node(slot);
      cost += measure_both(measure_, united(ancestor.box, l.box))[0] - ancestor.measure;
    }
    return cost;
  }

 private:
  // A search node not yet visited: induced cost above, record below. Induced costs are not negative, and such floats order as
  // their bits do, so that one integer comparison orders entries, and ties go by record: results do not depend on the heap.
  using Entry = std::uint64_t;
  static constexpr Entry none = ~Entry{0};
  static Entry entry(float induced, std::uint32_t p) { return (Entry{std::bit_cast<std::uint32_t>(induced)} << 32U) | p; }
  static float key(Entry e) { return std::bit_cast<float>(static_cast<std::uint32_t>(e >> 32U)); }
  static std::uint32_t record(Entry e) { return static_cast<std::uint32_t>(e); }

  /// The least of the heap and two more entries; the others stay in the heap.
  Entry least_of(const std::array<Entry, 2>& more) {
    const Entry first = std::min(more[0], more[1]);
    const Entry second = std::max(more[0], more[1]);
    if (second != none) heap_.push(second);
    if (heap_.empty() || first <= heap_.top()) return first;
    return first == none ? heap_.pop() : heap_.replace_top(first);
  }

  Entry visit_root(const Node& l, Place& best) {
    const Pair& top = tree_.pairs[0];
    const float merged = measure_both(measure_, united(top.boxes, l.box))[0];
    if (merged < best.cost) best = {0, merged};
    return PairTree::is_leaf(top.link[0]) ? none : entry(merged - top.measure[0], top.link[0]);
  }

  /// Recomputes the boxes of record p's node and its ancestors, up to where nothing changes.
  void refit_up(std::uint32_t p) {
    while (p != 0) {
      const std::uint32_t slot = tree_.up[p];
      const BoxPair box = tree_.pairs[p].boxes.merged();
      Pair& pair = tree_.pairs[slot / 2];
      const BoxPair old = pair.boxes.doubled(slot % 2);
      if (same(box, old)) return;
      set_box(pair, slot % 2, box);
      p = slot / 2;
    }
  }

  /// Extends the boxes of record p's node and its ancestors by `box`, up to where it is contained.
  void grow_up(std::uint32_t p, const BoxPair& box) {
    while (p != 0) {
      const std::uint32_t slot = tree_.up[p];
      Pair& pair = tree_.pairs[slot / 2];
      const BoxPair old = pair.boxes.doubled(slot % 2);
      const BoxPair larger = united(old, box);
      if (same(larger, old)) return;
      set_box(pair, slot % 2, larger);
      p = slot / 2;
    }
  }

  void set_box(Pair& pair, std::uint32_t side, const BoxPair& box) {
    const float m = measure_both(measure_, box)[0];
    inner_sum_ += static_cast<double>(m) - static_cast<double>(pair.measure[side]);
    pair.boxes.set(side, box);
    pair.measure[side] = m;
  }

  static bool same(const BoxPair& a, const BoxPair& b) {
    const auto differ = (a.x != b.x) | (a.y != b.y) | (a.z != b.z);
    return (differ[0] | differ[2]) == 0;
  }

  PairTree& tree_;
  const M& measure_;
  double inner_sum_ = 0;
  MinHeap heap_;
};

}  // namespace raystudy::insertion
