#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/base/parallel.h"
#include "harness/method/method.h"
#include "harness/method/running_cost.h"
#include "methods/insertion/bottom_up_search.h"
#include "methods/insertion/candidates.h"
#include "methods/insertion/conflicts.h"
#include "methods/insertion/tree_edit.h"

namespace raystudy::insertion {

/// How parallel reinsertion goes about it; README.md says which are the paper's.
struct ParallelOptions {
  bool modulo = false;  ///< passes over every µ-th candidate, not over the foremost ones
  Ranking ranking = Ranking::potential;
  bool children = true;         ///< both children of a node are tried together, besides single nodes
  double first_percent = 0.3;   ///< share of the candidates that the first passes are about, in %
  double last_percent = 10;     ///< share that the last passes are about
  double growth = 3;            ///< from one share to the next
  std::int64_t mu = 8;          ///< the first µ
  bool changed_only = true;     ///< leaves out those with nothing new about them since they were looked at
  bool path_conflicts = false;  ///< reinsertions whose paths meet exclude each other, not only those that touch the same node
  std::int64_t batch = 500;     ///< candidates that are searched in the same tree
  double loss = 0.2;            ///< of what both children free
  double tolerance = 0.0005;    ///< least relative fall of the cost in a pass that is worth another like it
  std::int64_t max_passes = 0;  ///< 0: no limit
  double max_seconds = 0;       ///< 0: no limit
};

/// Parallel reinsertion (Meister and Bittner 2018) over one tree. Searches run in parallel in the tree as it is; what they found
/// is applied in the order of gain, so that the result depends on neither threads nor timing.
template <class M>
class ParallelOptimization {
 public:
  using Clock = RunningCost::Clock;

  /// Everything referred to must outlive this; seconds are counted from `start`.
  ParallelOptimization(PairTree& tree, const M& measure, const ParallelOptions& options, const BuildContext& context,
                       Clock::time_point start)
      : tree_(tree),
        measure_(measure),
        options_(options),
        activity_(tree),
        edit_(tree, measure, Watch{&activity_}),
        running_(tree, context, start),
        candidates_(tree, options.modulo ? Ranking::none : options.ranking, options.children),
        conflicts_(tree, options.path_conflicts) {}

  /// True where the tree has come out no worse than it went in. A tree whose cost is not a finite number (a root of measure 0,
  /// areas past the range of float) is left as it is.
  bool run() {
    const double first = cost();
    running_.record(first);
    if (!std::isfinite(first)) return false;
    if (options_.modulo) {
      run_modulo();
    } else {
      run_shares();
    }
    return cost() <= first;
  }

 private:
  struct Watch {
    Activity* activity;
    void changed(std::uint32_t record) const { activity->changed(record); }
  };

  /// What a search found for a candidate: where it, or each of two children, is to be inserted.
  struct Move {
    float gain = 0;
    bool found = false;
    Candidate candidate;
    std::array<std::uint32_t, 2> to{};
  };

  [[nodiscard]] double cost() const { return running_.of(edit_.inner_sum()); }
  [[nodiscard]] bool is_over() const {
    return (options_.max_passes > 0 && passes_ >= options_.max_passes) || running_.out_of_time(options_.max_seconds);
  }

  /// Larger and larger shares of the candidates; of each, all, and then those near a change for as long as that helps.
  void run_shares() {
    const auto every = [](Candidate) { return true; };
    const auto active = [&](Candidate c) { return activity_.is_active(c); };
    std::vector<std::uint32_t> raised;
    for (double percent = std::min(options_.first_percent, options_.last_percent); !is_over();
         percent = std::min(percent * options_.growth, options_.last_percent)) {
      const bool last = percent >= options_.last_percent;
      loss_ = last ? 0.0F : static_cast<float>(options_.loss);
      candidates_.limit_to(percent / 100);
      activity_.take_raised(raised);
      bool helps = pass(candidates_.all(every));
      while (helps && !is_over()) {
        activity_.take_raised(raised);
        helps = pass(options_.changed_only ? candidates_.in(raised, active) : candidates_.all(every));
      }
      if (last) return;
    }
  }

  /// Every µ-th candidate, another remainder in each pass; µ falls by one where that hardly helps.
  void run_modulo() {
    for (auto mu = static_cast<std::uint32_t>(options_.mu); mu > 0 && !is_over();) {
      const auto remainder = static_cast<std::uint32_t>(passes_ % mu);
      const bool helps = pass(candidates_.all(
          [&](Candidate c) { return c.id() % mu == remainder && (!options_.changed_only || activity_.is_active(c)); }));
      if (!helps) --mu;
    }
  }

  /// Searches for all of the candidates, batch after batch, and applies what is found. False where the cost hardly fell.
  bool pass(const std::vector<Candidate>& candidates) {
    const double before = cost();
    const auto batch = static_cast<std::size_t>(options_.batch);
    for (std::size_t begin = 0; begin < candidates.size(); begin += batch) {
      if (running_.out_of_time(options_.max_seconds)) return false;
      search(candidates.data() + begin, std::min(batch, candidates.size() - begin));
      apply();
      running_.record(cost());
    }
    ++passes_;
    return cost() < before * (1 - options_.tolerance);
  }

  void search(const Candidate* candidates, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) activity_.settle(candidates[i]);
    moves_.resize(count);
    constexpr std::size_t grain = 16;
    constexpr std::size_t ahead = 4;
    parallel_for_blocks(count, grain, [&](std::size_t begin, std::size_t end) {
      BottomUpSearch<M> search(tree_, measure_);
      for (std::size_t i = begin; i < end; ++i) {
        if (i + ahead < end) prefetch(candidates[i + ahead]);
        moves_[i] = best_move(search, candidates[i]);
      }
    });
  }

  void prefetch(Candidate c) const {
    __builtin_prefetch(&tree_.pairs[c.record()]);
    __builtin_prefetch(&tree_.up[c.record()]);
  }

  Move best_move(BottomUpSearch<M>& search, Candidate c) const {
    if (c.is_node()) {
      const auto place = search.of_node(c.slot());
      return {place.gain, place.gain > 0, c, {place.slot, place.slot}};
    }
    if (c.record() == tree_.root()) return {0, false, c, {}};  // it became the root after the candidates were chosen
    const auto places = search.of_children(c.record());
    const float gain = places.freed - places.cost;
    // Beside the same node they would be siblings again.
    const bool found = places.slot[0] != places.slot[1] && gain > (BottomUpSearch<M>::least_gain - loss_) * places.freed;
    return {gain, found, c, places.slot};
  }

  /// Applies what was found, the largest gain first, as far as it does not conflict with what came before. What is left stays
  /// active.
  void apply() {
    moves_.erase(std::remove_if(moves_.begin(), moves_.end(), [](const Move& m) { return !m.found; }), moves_.end());
    std::sort(moves_.begin(), moves_.end(), [](const Move& a, const Move& b) {
      return a.gain != b.gain ? a.gain > b.gain : a.candidate.id() < b.candidate.id();
    });
    conflicts_.begin_batch();
    for (const Move& move : moves_) {
      activity_.raise(move.candidate);
      if (move.candidate.is_node()) {
        reinsert_node(move.candidate.slot(), move.to[0]);
      } else {
        reinsert_children(move.candidate.record(), move.to);
      }
    }
  }

  void reinsert_node(std::uint32_t slot, std::uint32_t to) {
    if (!conflicts_.take_node(slot, to)) return;
    const auto removed = edit_.remove_child(slot / 2, slot % 2);
    edit_.insert(removed.node, to, removed.free);
  }

  void reinsert_children(std::uint32_t inner, std::array<std::uint32_t, 2> to) {
    if (inner == tree_.root() || !conflicts_.take_children(inner, to)) return;
    const auto& measure = tree_.pairs[inner].measure;
    if (measure[1] > measure[0]) std::swap(to[0], to[1]);  // removal gives back the larger first
    const auto removed = edit_.remove(inner);
    for (std::size_t i = 0; i < 2; ++i) edit_.insert(removed.nodes[i], to[i], removed.free[i]);
  }

  PairTree& tree_;
  const M& measure_;
  ParallelOptions options_;
  Activity activity_;
  TreeEdit<M, PairTree, Watch> edit_;
  RunningCost running_;
  Candidates candidates_;
  Conflicts conflicts_;
  std::vector<Move> moves_;
  float loss_ = 0;  ///< the share of what both children free that their insertion may seem to cost more than that
  std::int64_t passes_ = 0;
};

}  // namespace raystudy::insertion
