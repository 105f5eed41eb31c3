#pragma once

#include <cstdint>

namespace raystudy::insertion {

enum class Selection : std::uint8_t { area_then_random, area, random, metropolis_hastings };

/// Bittner 2015, Sections 2.3 to 2.5; the defaults are Section 3's.
struct Options {
  double batch_percent = 1;        ///< k: nodes updated in a pass, % of all nodes
  std::int64_t stop_passes = 10;   ///< p_T
  std::int64_t random_passes = 5;  ///< p_R
  Selection selection = Selection::area_then_random;
  bool both_children = true;
  bool keep_best = false;
  std::int64_t max_passes = 0;  ///< 0: no limit
  double max_seconds = 0;       ///< 0: no limit
};

/// When to select at random and when to stop: counts the passes since the cost last fell below all before (Section 2.5). The
/// switch to random selection begins a new count, so that random selection has its own p_T passes to improve on the least cost.
class Progress {
 public:
  Progress(const Options& options, double first_cost)
      : options_(options), least_(first_cost), random_(options.selection == Selection::random) {}

  /// Takes the cost after a pass; true where it is the least so far.
  bool add_pass(double cost) {
    ++passes_;
    if (cost < least_) {
      least_ = cost;
      stalled_ = 0;
      return true;
    }
    ++stalled_;
    if (options_.selection == Selection::area_then_random && !random_ && stalled_ >= options_.random_passes) {
      random_ = true;
      stalled_ = 0;
    }
    return false;
  }

  [[nodiscard]] double least() const { return least_; }
  [[nodiscard]] bool selects_at_random() const { return random_; }
  [[nodiscard]] bool is_done() const {
    return stalled_ >= options_.stop_passes || (options_.max_passes > 0 && passes_ >= options_.max_passes);
  }

 private:
  Options options_;
  double least_;
  std::int64_t passes_ = 0;
  std::int64_t stalled_ = 0;
  bool random_;
};

}  // namespace raystudy::insertion
