#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "harness/accel/pair_tree.h"
#include "harness/method/pair_measure.h"
#include "methods/insertion/min_heap.h"
#include "methods/insertion/tree_edit.h"

namespace raystudy::insertion {

/// The updates of Bittner, Hapala and Havran: removal, branch-and-bound search, reinsertion (Bittner 2015, Section 2.3).
///
/// `M` and `Tree` as of TreeEdit; the measure must not decrease when a box grows. Over several frames (T-SAH) a node's measure is
/// the weighted sum of its frames' measures: all costs are linear in it, so that the sums over the frames are searched as the
/// scalars of one frame are.
template <class M, class Tree = PairTree>
class Reinsertion : public TreeEdit<M, Tree> {
  using Edit = TreeEdit<M, Tree>;

 public:
  using Edit::insert;
  using Edit::remove;
  using Edit::remove_child;
  using typename Edit::Node;
  using typename Edit::Pair;
  using typename Edit::Removed;
  using typename Edit::RemovedOne;

  /// Where a node may be merged in, and what that costs: C(L, X) = C_D(L, X) + C_I(L, X).
  struct Place {
    std::uint32_t slot = 0;
    float cost = std::numeric_limits<float>::infinity();
  };

  using Edit::Edit;

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
      const auto merged = measure_both(measure_, united(pair.boxes, l.box));
      std::array<Entry, 2> below{none, none};
      for (std::uint32_t side = 0; side < 2; ++side) {
        const float total = induced + merged[side];
        if (total < best.cost) best = {2 * p + side, total};
      }
      for (std::uint32_t side = 0; side < 2; ++side) {
        const float induced_below = induced + (merged[side] - pair.measure[side]);
        if (Tree::is_leaf(pair.link[side]) || !(induced_below + own < best.cost)) continue;
        below[side] = entry(induced_below, pair.link[side]);
        prefetch(tree_.pairs[pair.link[side]]);
      }
      next = least_of(below);
    }
    return best;
  }

  /// Fetches what an update of `n` touches first: in two steps, for the second needs what the first fetched.
  void prefetch_soon(std::uint32_t n) const {
    __builtin_prefetch(&tree_.up[n]);
    prefetch(tree_.pairs[n]);
  }
  void prefetch_next(std::uint32_t n) const {
    const std::uint32_t parent = tree_.up[n] / 2;
    prefetch(tree_.pairs[parent]);
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
    return Tree::is_leaf(top.link[0]) ? none : entry(merged - top.measure[0], top.link[0]);
  }

  using Edit::measure_;
  using Edit::tree_;
  MinHeap heap_;
};

}  // namespace raystudy::insertion
