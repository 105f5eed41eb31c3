#include "harness/method/compaction.h"
#include "harness/method/registry.h"

namespace raystudy::metrics {

class CompactedCost final : public Metric {
 public:
  explicit CompactedCost(const Params&) {}
  static MethodInfo info() {
    return {.name = "ocost",
            .summary = "cost after subtrees are collapsed to leaves wherever that is cheaper",
            .citation = "Bittner, Hapala, Havran 2015, section 2.6",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "ocost", .unit = "1"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext& context) const override {
    return {{.name = "ocost", .unit = "1", .values = {compacted_cost(dynamic_cast<const Bvh2&>(accel), context.cost)}}};
  }
};

const Registration<CompactedCost> ocost;

}  // namespace raystudy::metrics
