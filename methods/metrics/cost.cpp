#include "harness/method/registry.h"

namespace raystudy::metrics {

class Cost final : public Metric {
 public:
  explicit Cost(const Params&) {}
  static MethodInfo info() {
    return {.name = "cost",
            .summary = "expected cost of a ray that meets the root, under the experiment's cost model",
            .citation = "Bittner, Hapala, Havran 2015, Eq. 1",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "cost", .unit = "1"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext& context) const override {
    return {{.name = "cost", .unit = "1", .values = {tree_cost(dynamic_cast<const Bvh2&>(accel), context.cost)}}};
  }
};

const Registration<Cost> cost;

}  // namespace raystudy::metrics
