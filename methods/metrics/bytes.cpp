#include "harness/method/registry.h"

namespace raystudy::metrics {

class Bytes final : public Metric {
 public:
  explicit Bytes(const Params&) {}
  static MethodInfo info() {
    return {.name = "bytes",
            .summary = "memory the structure needs to be traced, without the scene's vertices and triangles",
            .citation = "harness/accel/accel.h",
            .values = {{.name = "bytes", .unit = "bytes"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext&) const override {
    return {{.name = "bytes", .unit = "bytes", .values = {static_cast<double>(accel.bytes())}}};
  }
};

const Registration<Bytes> bytes;

}  // namespace raystudy::metrics
