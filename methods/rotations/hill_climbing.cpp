#include <cmath>
#include <cstdint>

#include "harness/method/registry.h"
#include "harness/method/running_cost.h"
#include "methods/rotations/rotations.h"

namespace raystudy::rotations {
namespace {

class HillClimbing final : public Optimizer {
 public:
  static MethodInfo info() {
    return {.name = "rotation-hill-climbing",
            .summary = "rotates every node to its least cost, bottom up, until no rotation lowers the cost",
            .citation = "Kensler: Tree Rotations for Improving Bounding Volume Hierarchies, IEEE Interactive Ray Tracing 2008",
            .params = {integer_param("max_passes", 0, "stops after this many passes; 0: no limit", 0, 1e9),
                       real_param("max_seconds", 0, "stops after this time, in seconds; 0: no limit", 0, 1e9)},
            .accel = "bvh2"};
  }

  explicit HillClimbing(const Params& p) : max_passes_(p.integer("max_passes")), max_seconds_(p.real("max_seconds")) {}

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& measure, auto start) {
      Rotator rotator(tree, measure);
      const RunningCost running(tree, context, start);
      const double first = running.of(rotator.inner_sum());
      running.record(first);
      if (std::isfinite(first)) climb_all(tree, rotator, running, max_seconds_, max_passes_);
      return true;
    });
  }

 private:
  std::int64_t max_passes_;
  double max_seconds_;
};

const Registration<HillClimbing> registration;

}  // namespace
}  // namespace raystudy::rotations
