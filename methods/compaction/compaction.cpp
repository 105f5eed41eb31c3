#include "harness/method/compaction.h"

#include <chrono>
#include <cstdint>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

class Compaction final : public Optimizer {
 public:
  static MethodInfo info() {
    return {.name = "compaction",
            .summary = "collapses every subtree that costs more than one leaf over its triangles",
            .citation = "Bittner: Optimized Data Structures for Ray Tracing, 2015, Section 2.6",
            .params = {integer_param("max_leaf_triangles", 0, "makes no larger leaves; 0: no limit", 0, 4294967295.0)},
            .accel = "bvh2"};
  }

  explicit Compaction(const Params& p) : max_leaf_triangles_(static_cast<std::uint32_t>(p.integer("max_leaf_triangles"))) {}

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    const auto start = Clock::now();
    const auto record = [&](double seconds) {
      if (context.cost_trace != nullptr) context.cost_trace->push_back({seconds, tree_cost(bvh, context.cost)});
    };
    record(0);
    compact(bvh, context.cost, max_leaf_triangles_);
    record(std::chrono::duration<double>(Clock::now() - start).count());
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::uint32_t max_leaf_triangles_;
};

const Registration<Compaction> registration;

}  // namespace
}  // namespace raystudy
