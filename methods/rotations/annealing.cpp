#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "harness/method/registry.h"
#include "harness/method/running_cost.h"
#include "methods/rotations/rotations.h"

namespace raystudy::rotations {
namespace {

struct Schedule {
  std::int64_t passes = 0;
  double first_temperature = 0;
  double last_temperature = 0;
  double max_seconds = 0;
};

/// Simulated annealing over the rotations of one tree.
template <class M>
class Annealing {
 public:
  Annealing(PairTree& tree, const M& measure, const Schedule& schedule, const BuildContext& context,
            RunningCost::Clock::time_point start)
      : tree_(tree), measure_(measure), schedule_(schedule), context_(context), start_(start), random_(context.seed) {}

  void run() {
    anneal();
    // The cheapest tree of a warm run is not yet a local minimum.
    Rotator<M> rotator(tree_, measure_);
    const RunningCost running(tree_, context_, start_);
    if (std::isfinite(running.of(rotator.inner_sum()))) climb_all(tree_, rotator, running, schedule_.max_seconds, 0);
  }

 private:
  /// Leaves the cheapest tree that stood at the end of a pass, or the first.
  void anneal() {
    Rotator<M> rotator(tree_, measure_);
    const RunningCost running(tree_, context_, start_);
    double least = running.of(rotator.inner_sum());
    running.record(least);
    if (!std::isfinite(least)) return;
    PairTree best = tree_;
    for (std::int64_t pass = 0; pass < schedule_.passes && !running.out_of_time(schedule_.max_seconds); ++pass) {
      sweep(rotator, temperature(pass));
      const double now = running.of(rotator.inner_sum());
      running.record(now);
      if (now < least) {
        least = now;
        best = tree_;
      }
    }
    tree_ = best;
  }

  /// Geometric cooling.
  [[nodiscard]] double temperature(std::int64_t pass) const {
    const double progress = schedule_.passes > 1 ? static_cast<double>(pass) / static_cast<double>(schedule_.passes - 1) : 1;
    return schedule_.first_temperature * std::pow(schedule_.last_temperature / schedule_.first_temperature, progress);
  }

  void sweep(Rotator<M>& rotator, double t) {
    list_bottom_up(tree_, order_);
    for (const std::uint32_t n : order_) {
      const std::uint32_t slot = tree_.up[n];
      const double scale = t * static_cast<double>(tree_.pairs[slot / 2].measure[slot % 2]);
      if (!(scale > 0)) continue;  // a box of measure 0: nothing below it can cost anything
      const std::size_t chosen = choose(rotator.deltas(n), scale);
      if (chosen < rotation_count) rotator.apply(n, static_cast<Rotation>(chosen));
    }
  }

  /// One of the rotations, or rotation_count for none, each with a probability in proportion to exp(-delta / scale).
  std::size_t choose(const Deltas& deltas, double scale) {
    constexpr double never = 37;  // exp(-37) is below the least step of the random numbers
    const double least = std::min(0.0, *std::min_element(deltas.begin(), deltas.end()));
    const auto weight = [&](double delta) {
      const double x = (delta - least) / scale;
      return x < never ? std::exp(-x) : 0.0;
    };
    std::array<double, rotation_count> weights{};
    double sum = 0;
    for (std::size_t i = 0; i < rotation_count; ++i) sum += weights[i] = weight(deltas[i]);
    if (sum == 0) return rotation_count;
    double at = static_cast<double>(random_() >> 11U) * 0x1p-53 * (sum + weight(0));
    for (std::size_t i = 0; i < rotation_count; ++i) {
      at -= weights[i];
      if (at < 0) return i;
    }
    return rotation_count;
  }

  PairTree& tree_;
  const M& measure_;
  Schedule schedule_;
  const BuildContext& context_;
  RunningCost::Clock::time_point start_;
  std::mt19937_64 random_;
  std::vector<std::uint32_t> order_;
};

class RotationAnnealing final : public Optimizer {
 public:
  static MethodInfo info() {
    return {.name = "rotation-annealing",
            .summary = "rotates nodes at random under a falling temperature, keeps the cheapest tree, and climbs to its minimum",
            .citation = "Kensler: Tree Rotations for Improving Bounding Volume Hierarchies, IEEE Interactive Ray Tracing 2008",
            .params = {integer_param("passes", 500, "passes over all nodes", 0, 1e9),
                       real_param("first_temperature", 0.1,
                                  "in the first pass, in c_T: a rotation that raises the cost of its node "
                                  "by this weighs 1/e as much as none",
                                  1e-9, 1e9),
                       real_param("last_temperature", 0.01, "in the last pass; between them it falls geometrically", 1e-9, 1e9),
                       real_param("max_seconds", 0, "stops after this time, in seconds; 0: no limit", 0, 1e9)},
            .accel = "bvh2"};
  }

  explicit RotationAnnealing(const Params& p)
      : schedule_{p.integer("passes"), p.real("first_temperature"), p.real("last_temperature"), p.real("max_seconds")} {}

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& measure, auto start) {
      Annealing(tree, measure, schedule_, context, start).run();
      return true;
    });
  }

 private:
  Schedule schedule_;
};

const Registration<RotationAnnealing> registration;

}  // namespace
}  // namespace raystudy::rotations
