#include "harness/method/registry.h"

namespace raystudy::metrics {

class Nodes final : public Metric {
 public:
  explicit Nodes(const Params&) {}
  static MethodInfo info() {
    return {.name = "nodes",
            .summary = "number of nodes, inner nodes and leaves together",
            .citation = "harness/accel/bvh2.h",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "nodes", .unit = "1"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext&) const override {
    const auto& bvh = dynamic_cast<const Bvh2&>(accel);
    return {{.name = "nodes", .unit = "1", .values = {static_cast<double>(bvh.inner_count() + bvh.leaf_count())}}};
  }
};

const Registration<Nodes> nodes;

}  // namespace raystudy::metrics
