#include "harness/method/registry.h"

namespace raystudy::metrics {

class Leaves final : public Metric {
 public:
  explicit Leaves(const Params&) {}
  static MethodInfo info() {
    return {.name = "leaves",
            .summary = "number of leaves",
            .citation = "harness/accel/bvh2.h",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "leaves", .unit = "1"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext&) const override {
    const auto count = dynamic_cast<const Bvh2&>(accel).leaf_count();
    return {{.name = "leaves", .unit = "1", .values = {static_cast<double>(count)}}};
  }
};

const Registration<Leaves> leaves;

}  // namespace raystudy::metrics
