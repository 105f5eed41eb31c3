#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/method/method.h"
#include "harness/method/running_cost.h"
#include "methods/insertion/passes.h"
#include "methods/insertion/reinsertion.h"
#include "methods/insertion/selection.h"

namespace raystudy::insertion {

/// The passes of the insertion-based optimization over one tree (Bittner 2015, Sections 2.1, 2.4 and 2.5).
template <class M, class Tree>
class Optimization {
 public:
  using Clock = RunningCost::Clock;

  /// Everything referred to must outlive this; seconds are counted from `start`.
  Optimization(Tree& tree, const M& measure, const Options& options, const BuildContext& context, Clock::time_point start)
      : tree_(tree),
        options_(options),
        reinsertion_(tree, measure),
        running_(tree, context, start),
        selector_(context.seed),
        batch_(batch_size(options.batch_percent, tree.inner_count(), tree.leaves.size())) {}

  /// `reweigh` is called after every pass; where it says that it has changed the measure, the tree is measured anew before its
  /// cost is taken.
  void after_passes(std::function<bool()> reweigh) { reweigh_ = std::move(reweigh); }

  /// True where the tree has come out no worse than it went in. A tree whose cost is not a finite number (a root of measure 0,
  /// areas past the range of float) is left as it is.
  bool run() {
    const double first = cost();
    running_.record(first);
    if (!std::isfinite(first)) return false;
    Progress progress(options_, first);
    while (!progress.is_done() && !running_.out_of_time(options_.max_seconds)) {
      update(select(progress));
      if (reweigh_ && reweigh_()) {
        reinsertion_.remeasure();
        running_.remeasured(tree_);
      }
      const double now = cost();
      running_.record(now);
      if (progress.add_pass(now) && options_.keep_best) best_ = tree_;
    }
    if (best_) {
      tree_ = *best_;
      running_.record(progress.least());
    }
    return best_ || cost() <= first;
  }

 private:
  [[nodiscard]] double cost() const { return running_.of(reinsertion_.inner_sum()); }

  const std::vector<std::uint32_t>& select(const Progress& progress) {
    if (options_.selection == Selection::metropolis_hastings) return selector_.by_metropolis_hastings(tree_, batch_);
    return progress.selects_at_random() ? selector_.at_random(tree_, batch_) : selector_.by_area(tree_, batch_);
  }

  /// A selected node may have been taken out and put in elsewhere by an earlier update of the same pass; it is updated where it
  /// stands now. Only the root, which has no parent, is passed over.
  void update(const std::vector<std::uint32_t>& selected) {
    constexpr std::size_t between_looks_at_the_clock = 256;
    for (std::size_t i = 0; i < selected.size(); ++i) {
      if (i % between_looks_at_the_clock == 0 && running_.out_of_time(options_.max_seconds)) return;
      if (i + 8 < selected.size()) reinsertion_.prefetch_soon(selected[i + 8]);
      if (i + 4 < selected.size()) reinsertion_.prefetch_next(selected[i + 4]);
      if (selected[i] == tree_.root()) continue;
      if (options_.both_children) {
        reinsertion_.update_both(selected[i]);
      } else {
        reinsertion_.update_larger(selected[i]);
      }
    }
  }

  Tree& tree_;
  Options options_;
  Reinsertion<M, Tree> reinsertion_;
  RunningCost running_;
  Selector selector_;
  std::size_t batch_;
  std::optional<Tree> best_;
  std::function<bool()> reweigh_;
};

}  // namespace raystudy::insertion
