// Methods that exist only where the reading of experiments is tested, so that its messages do not change with what is registered.
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

class TestBuilder final : public Builder {
 public:
  explicit TestBuilder(const Params&) {}
  static MethodInfo info() {
    return {.name = "test-builder",
            .summary = "builds nothing",
            .citation = "",
            .params = {integer_param("bins", 16, "bins", 2, 256), choice_param("centres", {"box", "centroid"}, "what orders"),
                       boolean_param("parallel", false, "on all threads"), text_param("note", "", "anything"),
                       method_param("heuristic", Role::heuristic, "surface-area", "the measure")},
            .accel = "bvh2"};
  }
  [[nodiscard]] std::unique_ptr<Accel> build(const Scene&, const BuildContext&) const override {
    return std::make_unique<Bvh2>();
  }
};

class TestForeignBuilder final : public Builder {
 public:
  explicit TestForeignBuilder(const Params&) {}
  static MethodInfo info() { return {.name = "test-foreign", .summary = "", .citation = "", .accel = "foreign"}; }
  [[nodiscard]] std::unique_ptr<Accel> build(const Scene&, const BuildContext&) const override {
    return std::make_unique<Bvh2>();
  }
};

class TestOptimizer final : public Optimizer {
 public:
  explicit TestOptimizer(const Params&) {}
  static MethodInfo info() {
    ParamSpec percent = real_param("percent", 1, "share of the nodes [%]", 0, 100);
    percent.lowest_is_open = true;
    return {.name = "test-optimizer",
            .summary = "",
            .citation = "",
            .params = {percent, integer_param("bins", 4, "", 1, 8)},
            .accel = "bvh2"};
  }
  void optimize(Bvh2&, const Scene&, const BuildContext&) const override {}
};

class TestEncoder final : public Encoder {
 public:
  explicit TestEncoder(const Params&) {}
  static MethodInfo info() { return {.name = "test-encoder", .summary = "", .citation = "", .accel = "wide"}; }
  [[nodiscard]] std::unique_ptr<Accel> encode(const Bvh2&, const Scene&, const BuildContext&) const override {
    return std::make_unique<Bvh2>();
  }
};

template <int number>
class TestTracer final : public Tracer {
 public:
  explicit TestTracer(const Params&) {}
  static MethodInfo info() {
    MethodInfo info{.name = "test-tracer", .summary = "", .citation = "", .accel = "bvh2"};
    if (number == 1) info = {.name = "test-wide-tracer", .summary = "", .citation = "", .accel = "wide"};
    return info;
  }
  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel&, const Scene&, int, bool) const override { return nullptr; }
};

class TestWorkload final : public Workload {
 public:
  explicit TestWorkload(const Params&) {}
  static MethodInfo info() {
    return {.name = "test-rays", .summary = "", .citation = "", .params = {integer_param("count", 1000, "rays", 1, 1e9)}};
  }
  [[nodiscard]] RayBatch generate(const Scene&, const WorkloadContext&) const override { return {}; }
};

class TestMetric final : public Metric {
 public:
  explicit TestMetric(const Params&) {}
  static MethodInfo info() {
    return {.name = "test-metric",
            .summary = "",
            .citation = "",
            .accel = "wide",
            .values = {{"test_cost", ""}, {"test_curve", "", "", "depth"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel&, const Scene&, const BuildContext&) const override { return {}; }
};

class TestUpdater final : public Updater {
 public:
  explicit TestUpdater(const Params&) {}
  static MethodInfo info() {
    return {.name = "test-updater",
            .summary = "",
            .citation = "",
            .params = {integer_param("every", 1, "frames", 1, 100)},
            .accel = "bvh2"};
  }
  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene&, std::span<const double>, const TreeBuild&,
                                                       const BuildContext&) const override {
    return nullptr;
  }
};

const Registration<TestBuilder> builder;
const Registration<TestForeignBuilder> foreign;
const Registration<TestOptimizer> optimizer;
const Registration<TestEncoder> encoder;
const Registration<TestTracer<0>> tracer;
const Registration<TestTracer<1>> wide_tracer;
const Registration<TestWorkload> workload;
const Registration<TestMetric> metric;
const Registration<TestUpdater> updater;

}  // namespace
}  // namespace raystudy
