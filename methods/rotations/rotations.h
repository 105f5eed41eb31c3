#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/method/pair_measure.h"
#include "harness/method/running_cost.h"

namespace raystudy::rotations {

/// The rotations at a node with children l, r and grandchildren ll, lr, rl, rr (Kensler 2008): what is swapped. The other two
/// swaps of grandchildren give mirror images of the last two.
enum class Rotation : std::uint8_t { l_rl, l_rr, r_ll, r_lr, ll_rl, ll_rr };
inline constexpr std::size_t rotation_count = 6;
constexpr std::size_t index(Rotation rotation) { return static_cast<std::size_t>(rotation); }

/// By how much each rotation changes Σ_inner m(N); infinite where a leaf stands in the way of it.
using Deltas = std::array<double, rotation_count>;

/// Rotations of a measured tree. They leave the boxes of the node and its ancestors as they are. `M` is SurfaceArea or
/// AnyMeasure.
template <class M>
class Rotator {
 public:
  using Pair = PairTree::Pair;

  /// `tree` is measured here; it and `measure` must outlive this.
  Rotator(PairTree& tree, const M& measure) : tree_(tree), measure_(measure) {
    measure_all(tree_, measure_);
    inner_sum_ = inner_measure_sum(tree_);
  }

  /// Of a tree that is not measured yet: whoever has measured the two nodes below record n calls `refit(n)`, children first, and
  /// asks for no sum.
  struct Unmeasured {};
  Rotator(PairTree& tree, const M& measure, Unmeasured) : tree_(tree), measure_(measure) {}

  [[nodiscard]] double inner_sum() const { return inner_sum_; }

  /// What each rotation at inner node `n` would change.
  [[nodiscard]] Deltas deltas(std::uint32_t n) const {
    constexpr double impossible = std::numeric_limits<double>::infinity();
    Deltas result{impossible, impossible, impossible, impossible, impossible, impossible};
    const Pair& node = tree_.pairs[n];
    const auto left_measure = static_cast<double>(node.measure[0]);
    const auto right_measure = static_cast<double>(node.measure[1]);
    const bool left_is_inner = !PairTree::is_leaf(node.link[0]);
    const bool right_is_inner = !PairTree::is_leaf(node.link[1]);
    if (right_is_inner) {  // l takes the place of one of r's children, and r covers l and the other
      const Float4 merged = measure_both(measure_, united(below(node, 1), node.boxes.doubled(0)));
      result[index(Rotation::l_rl)] = static_cast<double>(merged[1]) - right_measure;
      result[index(Rotation::l_rr)] = static_cast<double>(merged[0]) - right_measure;
    }
    if (left_is_inner) {
      const Float4 merged = measure_both(measure_, united(below(node, 0), node.boxes.doubled(1)));
      result[index(Rotation::r_ll)] = static_cast<double>(merged[1]) - left_measure;
      result[index(Rotation::r_lr)] = static_cast<double>(merged[0]) - left_measure;
    }
    if (left_is_inner && right_is_inner) {
      const Float4 crossed = measure_both(measure_, united(below(node, 0), below(node, 1).swapped()));
      const Float4 parallel = measure_both(measure_, united(below(node, 0), below(node, 1)));
      const double old = left_measure + right_measure;
      result[index(Rotation::ll_rl)] = static_cast<double>(crossed[0]) + static_cast<double>(crossed[1]) - old;
      result[index(Rotation::ll_rr)] = static_cast<double>(parallel[0]) + static_cast<double>(parallel[1]) - old;
    }
    return result;
  }

  /// Applies a rotation of finite delta.
  void apply(std::uint32_t n, Rotation rotation) {
    const std::array<std::uint32_t, 2> child = tree_.pairs[n].link;
    switch (rotation) {
      case Rotation::l_rl: exchange(2 * n, 2 * child[1]); break;
      case Rotation::l_rr: exchange(2 * n, 2 * child[1] + 1); break;
      case Rotation::r_ll: exchange(2 * n + 1, 2 * child[0]); break;
      case Rotation::r_lr: exchange(2 * n + 1, 2 * child[0] + 1); break;
      case Rotation::ll_rl: exchange(2 * child[0], 2 * child[1]); break;
      case Rotation::ll_rr: exchange(2 * child[0], 2 * child[1] + 1); break;
    }
    const bool right_changed = rotation != Rotation::r_ll && rotation != Rotation::r_lr;
    const bool left_changed = rotation != Rotation::l_rl && rotation != Rotation::l_rr;
    // After a child has moved down, its record is below the other child's, which stays where it was.
    if (left_changed) refit(child[0]);
    if (right_changed) refit(child[1]);
  }

  /// Puts inner node `n` around its children, and measures it.
  void refit(std::uint32_t n) {
    const std::uint32_t slot = tree_.up[n];
    Pair& pair = tree_.pairs[slot / 2];
    const BoxPair box = tree_.pairs[n].boxes.merged();
    const float m = measure_both(measure_, box)[0];
    inner_sum_ += static_cast<double>(m) - static_cast<double>(pair.measure[slot % 2]);
    pair.boxes.set(slot % 2, box);
    pair.measure[slot % 2] = m;
  }

  /// The rotation at `n` that lowers the cost most, where one does. True where it did.
  bool climb(std::uint32_t n) {
    const Deltas all = deltas(n);
    const auto best = std::min_element(all.begin(), all.end());
    if (!(*best < 0)) return false;
    apply(n, static_cast<Rotation>(best - all.begin()));
    return true;
  }

 private:
  /// The boxes of child `side`'s children.
  [[nodiscard]] const BoxPair& below(const Pair& node, std::uint32_t side) const { return tree_.pairs[node.link[side]].boxes; }

  void exchange(std::uint32_t a, std::uint32_t b) {
    const PairTree::Node at_a = tree_.node(a);
    const PairTree::Node at_b = tree_.node(b);
    tree_.put(a, at_b);
    tree_.put(b, at_a);
  }

  PairTree& tree_;
  const M& measure_;
  double inner_sum_ = 0;
};

/// Fills `order` with the inner nodes of a tree, children before parents, each subtree together.
void list_bottom_up(const PairTree& tree, std::vector<std::uint32_t>& order);

/// One pass of hill climbing: at each node, children first, the rotation that lowers the cost most, where one does. True where
/// any did.
template <class M>
bool climb(Rotator<M>& rotator, const std::vector<std::uint32_t>& bottom_up) {
  bool improved = false;
  for (const std::uint32_t n : bottom_up) {
    if (rotator.climb(n)) improved = true;
  }
  return improved;
}

/// Passes of hill climbing until no rotation lowers the cost, which must be finite; at most `max_passes`, 0: no limit. Every
/// rotation lowers the sum of measures, of which there are finitely many, so that passes come to an end.
template <class M>
void climb_all(const PairTree& tree, Rotator<M>& rotator, const RunningCost& running, double max_seconds,
               std::int64_t max_passes) {
  std::vector<std::uint32_t> order;
  bool improved = true;
  for (std::int64_t pass = 0; improved && (max_passes == 0 || pass < max_passes); ++pass) {
    if (running.out_of_time(max_seconds)) return;
    list_bottom_up(tree, order);
    improved = climb(rotator, order);
    running.record(running.of(rotator.inner_sum()));
  }
}

}  // namespace raystudy::rotations
