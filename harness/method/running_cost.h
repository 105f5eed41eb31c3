#pragma once

#include <chrono>

#include "harness/accel/pair_tree.h"
#include "harness/method/method.h"
#include "harness/method/pair_measure.h"

namespace raystudy {

/// Eq. 1 and its trace over time for an optimizer that keeps Σ_inner m(N) itself while it edits a tree.
class RunningCost {
 public:
  using Clock = std::chrono::steady_clock;

  /// `tree` is measured; neither what leaves cost together nor the root changes as long as leaves move whole. Seconds count from
  /// `start`.
  template <class Tree>
  RunningCost(const Tree& tree, const BuildContext& context, Clock::time_point start) : context_(context), start_(start) {
    remeasured(tree);
  }

  /// The tree has been measured anew, by another measure.
  template <class Tree>
  void remeasured(const Tree& tree) {
    root_ = static_cast<double>(tree.pairs[0].measure[0]);
    leaf_sum_ = leaf_measure_sum(tree);
  }

  /// The tree's cost, from the sum of its inner measures. Not a finite number where the root measures 0 or areas overflow.
  [[nodiscard]] double of(double inner_sum) const {
    const CostModel& model = context_.cost;
    const double sum = static_cast<double>(model.traversal) * inner_sum + static_cast<double>(model.intersection) * leaf_sum_;
    return sum / root_;
  }
  void record(double cost) const {
    if (context_.cost_trace != nullptr) context_.cost_trace->push_back({seconds(), cost});
  }
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// True where the run was stopped, or has taken `max_seconds` (0: no limit).
  [[nodiscard]] bool out_of_time(double max_seconds) const {
    return context_.stop_requested() || (max_seconds > 0 && seconds() >= max_seconds);
  }

 private:
  const BuildContext& context_;
  Clock::time_point start_;
  double root_ = 0;
  double leaf_sum_ = 0;
};

/// What an optimizer of whole trees begins and ends with: `edit(PairTree&, measure, start)` changes a copy of `bvh` and returns
/// whether it takes its place. A tree of fewer than three leaves has one form only and stays. The trace ends with what the tree
/// costs that comes out.
template <class Edit>
void edit_as_pairs(Bvh2& bvh, const BuildContext& context, const Edit& edit) {
  const auto start = RunningCost::Clock::now();
  if (bvh.leaf_count() < 3) {
    if (context.cost_trace != nullptr) context.cost_trace->push_back({0, tree_cost(bvh, context.cost)});
    return;
  }
  PairTree tree(bvh);
  const bool take = visit_measure(*context.cost.measure, [&](const auto& measure) -> bool { return edit(tree, measure, start); });
  if (take) {
    tree.write_to(bvh);
  } else if (context.cost_trace != nullptr && !context.cost_trace->empty()) {
    const std::chrono::duration<double> spent = RunningCost::Clock::now() - start;
    context.cost_trace->push_back({spent.count(), context.cost_trace->front().cost});
  }
}

}  // namespace raystudy
