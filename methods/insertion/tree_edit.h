#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "harness/accel/pair_tree.h"
#include "harness/method/pair_measure.h"

namespace raystudy::insertion {

/// Told of nothing.
struct Unwatched {
  void changed(std::uint32_t /*record*/) const {}
};

/// Removal and insertion of nodes (Bittner 2015, Section 2.3). Keeps every inner node's box the exact union of its children's,
/// and the sum of inner measures up to date.
///
/// `M` measures the Doubled boxes of `Tree`, a PairTreeOf (pair_measure.h, frame_boxes.h). `Watch` has `changed(record)`, called
/// for every record that gets another node or another box.
template <class M, class Tree = PairTree, class Watch = Unwatched>
class TreeEdit {
 public:
  using Node = typename Tree::Node;
  using Pair = typename Tree::Pair;
  using Doubled = typename Tree::Doubled;

  /// What removing an inner node leaves: the nodes to insert again, the larger first, and the two records that are free now.
  struct Removed {
    std::array<Node, 2> nodes;
    std::array<std::uint32_t, 2> free{};
    std::uint32_t old_slot = 0;  ///< where the sibling of the removed node now stands
  };

  /// `tree` is measured here; it and `measure` must outlive this.
  TreeEdit(Tree& tree, const M& measure, Watch watch = {}) : tree_(tree), measure_(measure), watch_(watch) { remeasure(); }

  /// After the measure has changed.
  void remeasure() {
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
    put(parent_slot, tree_.node(slot ^ 1U));
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
    put(slot, tree_.node((2 * n + side) ^ 1U));
    refit_up(slot / 2);
    return removed;
  }

  /// Merges `l` with what stands at `slot`, under record `free` as their parent (Fig. 5).
  void insert(const Node& l, std::uint32_t slot, std::uint32_t free) {
    const Node x = tree_.node(slot);
    put(2 * free, x);
    put(2 * free + 1, l);
    Node parent{united(x.box, l.box), free, 0};
    parent.measure = measure_both(measure_, parent.box)[0];
    inner_sum_ += static_cast<double>(parent.measure);
    put(slot, parent);
    grow_up(slot / 2, l.box);
  }

 protected:
  Tree& tree_;
  const M& measure_;

 private:
  /// Recomputes the boxes of record p's node and its ancestors, up to where nothing changes.
  void refit_up(std::uint32_t p) {
    while (p != 0) {
      const std::uint32_t slot = tree_.up[p];
      const Doubled box = tree_.pairs[p].boxes.merged();
      const Doubled old = tree_.pairs[slot / 2].boxes.doubled(slot % 2);
      if (same(box, old)) return;
      set_box(slot, box);
      p = slot / 2;
    }
  }

  /// Extends the boxes of record p's node and its ancestors by `box`, up to where it is contained.
  void grow_up(std::uint32_t p, const Doubled& box) {
    while (p != 0) {
      const std::uint32_t slot = tree_.up[p];
      const Doubled old = tree_.pairs[slot / 2].boxes.doubled(slot % 2);
      const Doubled larger = united(old, box);
      if (same(larger, old)) return;
      set_box(slot, larger);
      p = slot / 2;
    }
  }

  void set_box(std::uint32_t slot, const Doubled& box) {
    Pair& pair = tree_.pairs[slot / 2];
    const std::uint32_t side = slot % 2;
    const float m = measure_both(measure_, box)[0];
    inner_sum_ += static_cast<double>(m) - static_cast<double>(pair.measure[side]);
    pair.boxes.set(side, box);
    pair.measure[side] = m;
    watch_.changed(slot / 2);
  }

  void put(std::uint32_t slot, const Node& node) {
    tree_.put(slot, node);
    watch_.changed(slot / 2);
  }

  [[no_unique_address]] Watch watch_;
  double inner_sum_ = 0;
};

}  // namespace raystudy::insertion
