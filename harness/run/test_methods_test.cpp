// Methods that behave badly in every way a plugin can, registered in this folder's test executable only.
#include "harness/run/test_methods.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>
#include <thread>

#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"

namespace raystudy {
namespace {

/// A valid tree: one triangle a leaf, halves of the index range.
void build_range(const Scene& scene, Bvh2& bvh, std::size_t node, std::uint32_t first, std::uint32_t count) {
  if (count == 1) {
    bvh.nodes[node] = {scene.triangle_box(bvh.triangles[first]), first, 1};
    return;
  }
  const std::size_t pair = bvh.nodes.size();
  bvh.nodes.resize(pair + 2);
  build_range(scene, bvh, pair, first, count / 2);
  build_range(scene, bvh, pair + 1, first + count / 2, count - count / 2);
  Box box = bvh.nodes[pair].box;
  box.extend(bvh.nodes[pair + 1].box);
  bvh.nodes[node] = {box, static_cast<std::uint32_t>(pair), 0};
}

std::unique_ptr<Bvh2> good_tree(const Scene& scene) {
  auto bvh = std::make_unique<Bvh2>();
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) bvh->triangles.push_back(t);
  bvh->nodes.resize(2);
  build_range(scene, *bvh, 0, 0, static_cast<std::uint32_t>(scene.triangles.size()));
  return bvh;
}

void crash() {
  (void)std::signal(SIGSEGV, SIG_DFL);  // a sanitizer would turn it into an exit
  (void)raise(SIGSEGV);
}

void eat_memory() {
  static std::vector<std::vector<char>> eaten;
  for (;;) eaten.emplace_back(16 << 20, 'x');
}

void eat_memory_in_noexcept() noexcept { eat_memory(); }

class TestBuilder : public Builder {
 public:
  explicit TestBuilder(const Params& params) : behaviour_(params.text("behaviour")) {}
  static MethodInfo info() {
    return {.name = "test-builder",
            .summary = "behaves as it is told",
            .citation = "none",
            .params = {text_param("behaviour", "good", "what it does")},
            .accel = "bvh2",
            .parts = {"sort", "split"}};
  }
  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    static std::map<std::string, int> calls;
    const int call = ++calls[behaviour_];
    if (behaviour_ == "crash") crash();
    if (behaviour_ == "crash later" && call == 2) crash();
    if (behaviour_ == "abort") std::abort();
    if (behaviour_ == "exits") _exit(7);
    if (behaviour_ == "throw") throw Error(Diagnostic{{}, "no such luck", "more of it", {}});
    const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    if (behaviour_.starts_with("threads: ") && behaviour_ != fmt::format("threads: {}, {}", context.threads, allowed)) {
      throw Error(fmt::format("{} threads, and {} allowed", context.threads, allowed));
    }
    if (behaviour_ == "throw later" && call == 2) throw Error("no luck the second time");
    if (behaviour_ == "sleep") std::this_thread::sleep_for(std::chrono::hours(1));
    if (behaviour_ == "take 100 ms") std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (behaviour_ == "device" && context.device != nullptr) {
      *context.device = {.seconds = 3,
                         .upload = 0.5,
                         .download = 0.25,
                         .parts = {{"sort", 1}, {"split", 2}},
                         .levels = {{2, 1}, {1, 2}},
                         .peak_bytes = 4096};
    }
    if (behaviour_ == "eat memory") eat_memory();
    if (behaviour_ == "eat memory in noexcept") eat_memory_in_noexcept();
    if (behaviour_ == "hold 64 MiB") {
      std::vector<char> held(64 << 20, 'x');
      if (held[static_cast<std::size_t>(call)] != 'x') throw std::logic_error("never");
    }
    std::unique_ptr<Bvh2> bvh = good_tree(scene);
    if (behaviour_ == "wrong tree") bvh->nodes[2].box.lower.x += 1;
    return bvh;
  }

 private:
  std::string behaviour_;
};

class TestOptimizer : public Optimizer {
 public:
  explicit TestOptimizer(const Params&) {}
  static MethodInfo info() { return {.name = "test-optimizer", .summary = "pretends", .citation = "none", .accel = "bvh2"}; }
  void optimize(Bvh2&, const Scene&, const BuildContext& context) const override {
    if (context.cost_trace == nullptr) return;
    context.cost_trace->push_back({0, 100});
    context.cost_trace->push_back({1e-9, 90});
  }
};

/// Brute force over all triangles of the strip, with a fault where told.
class TestSession : public TraceSession {
 public:
  TestSession(const Scene& scene, std::string behaviour) : scene_(scene), behaviour_(std::move(behaviour)) {}
  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query) override {
    const int call = ++calls_;
    if (behaviour_ == "crash") crash();
    if (behaviour_ == "throw later" && call == 2) throw Error("lost the way");
    if (behaviour_ == "sleep later" && call == 2) std::this_thread::sleep_for(std::chrono::hours(1));
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = closest(rays[i]);
    if (behaviour_ == "miss one") hits[3] = {};
    if (behaviour_ == "hit too far") hits[5].t *= 1.5F;
    times_.seconds = 5;
  }
  [[nodiscard]] const DeviceTimes* device_times() const override { return behaviour_ == "device" ? &times_ : nullptr; }
  [[nodiscard]] bool counts() const override { return behaviour_ == "count"; }
  TraceCounts count(std::span<const Ray> rays, Query, std::span<std::uint32_t>) override {
    return {.inner_nodes = 3 * rays.size(),
            .leaves = 2 * rays.size(),
            .box_tests = 7 * rays.size(),
            .triangle_tests = 5 * rays.size()};
  }

 private:
  /// The rays go straight down onto the middle of a triangle each, one unit above.
  [[nodiscard]] Hit closest(const Ray& ray) const {
    const auto t = static_cast<std::uint32_t>(ray.origin.x * 2 - 0.5F);
    return t < scene_.triangles.size() ? Hit{1.0F, t, 0.5F, 0.25F} : Hit{};
  }
  const Scene& scene_;
  std::string behaviour_;
  int calls_ = 0;
  DeviceTimes times_;
};

class TestTracer : public Tracer {
 public:
  explicit TestTracer(const Params& params) : behaviour_(params.text("behaviour")) {}
  static MethodInfo info() {
    return {.name = "test-tracer",
            .summary = "behaves as it is told",
            .citation = "none",
            .params = {text_param("behaviour", "good", "what it does")}};
  }
  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel&, const Scene& scene, int, bool) const override {
    return std::make_unique<TestSession>(scene, behaviour_);
  }

 private:
  std::string behaviour_;
};

class TestWorkload : public Workload {
 public:
  explicit TestWorkload(const Params& params) : fails_(params.boolean("fails")) {}
  static MethodInfo info() {
    return {.name = "test-workload",
            .summary = "a ray down onto each triangle, and as many beside",
            .citation = "none",
            .params = {boolean_param("fails", false, "throws")}};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext&) const override {
    if (fails_) throw Error("no rays today");
    RayBatch batch;
    for (std::size_t t = 0; t < 2 * scene.triangles.size(); ++t) {
      // Half-way along z, triangle t spans x from t/2 to (t + 1)/2.
      const float x = (static_cast<float>(t) + 0.5F) / 2;
      batch.rays.push_back({{x, 1, 0.5F}, 0, {0, -1, 0}, 10});
    }
    return batch;
  }

 private:
  bool fails_;
};

/// Three numbers a tree can have, one of them wrong where told.
class TestMetric : public Metric {
 public:
  explicit TestMetric(const Params& params) : behaviour_(params.text("behaviour")) {}
  static MethodInfo info() {
    return {.name = "test-metric",
            .summary = "measures little",
            .citation = "none",
            .params = {text_param("behaviour", "good", "what it does")}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel&, const Scene&, const BuildContext&) const override {
    const double value = behaviour_ == "not finite" ? std::numeric_limits<double>::infinity() : 42;
    return {{"answer", "1", {value}}, {"by_depth", "m", {1, 2, 4}, "depth"}};
  }

 private:
  std::string behaviour_;
};

/// Builds a tree for every frame.
class TestUpdateSession : public UpdateSession {
 public:
  TestUpdateSession(TreeBuild build, std::string behaviour) : build_(std::move(build)), behaviour_(std::move(behaviour)) {}
  FrameUpdate update(const Scene& frame, std::size_t index) override {
    if (behaviour_ == "throw in frame 1" && index == 1) throw Error("lost the frame");
    if (behaviour_ == "crash in frame 1" && index == 1) crash();
    if (behaviour_ != "keep" || !tree_) tree_ = build_(frame);
    FrameUpdate result{tree_.get(), index % 2 == 1};
    if (behaviour_ == "device") result.device_seconds = 7;
    return result;
  }
  [[nodiscard]] std::size_t bytes() const override { return 100; }

 private:
  TreeBuild build_;
  std::string behaviour_;
  std::unique_ptr<Accel> tree_;
};

class TestUpdater : public Updater {
 public:
  explicit TestUpdater(const Params& params) : behaviour_(params.text("behaviour")) {}
  static MethodInfo info() {
    return {.name = "test-updater",
            .summary = "behaves as it is told",
            .citation = "none",
            .params = {text_param("behaviour", "good", "what it does")},
            .accel = "bvh2"};
  }
  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& scene, std::span<const double>, const TreeBuild& build,
                                                       const BuildContext&) const override {
    if (behaviour_ == "throw") throw Error("no session");
    if (behaviour_ != "build later") (void)build(scene);
    return std::make_unique<TestUpdateSession>(build, behaviour_);
  }

 private:
  std::string behaviour_;
};

const Registration<TestUpdater> updater;
const Registration<TestBuilder> builder;
const Registration<TestTracer> tracer;
const Registration<TestWorkload> workload;
const Registration<TestMetric> metric;
const Registration<TestOptimizer> optimizer;

}  // namespace

Scene open_test_scene(const SceneSpec& spec) {
  if (spec.name == "missing") throw SceneNotInstalled("scene not installed: raystudy scene get missing");
  if (spec.name == "broken") throw Error(Diagnostic{{"broken.ply", 3, 0}, "the file ends in the middle of a vertex", {}, {}});
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (int i = 0; i <= test_triangles / 2; ++i) {
    vertices.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
    vertices.emplace_back(static_cast<float>(i), 0.0F, 1.0F);
  }
  for (std::uint32_t i = 0; i < test_triangles; ++i) triangles.push_back({{i, i + 1, i + 2}});
  Scene scene;
  scene.name = spec.name;
  scene.vertices = SharedArray(std::move(vertices));
  scene.triangles = SharedArray(std::move(triangles));
  if (spec.name == "rising strip") {
    for (const float y : {0.0F, 1.0F}) {
      std::vector<Vec3> frame(scene.vertices.begin(), scene.vertices.end());
      for (std::size_t v = 0; v < frame.size(); ++v) frame[v].y = y * static_cast<float>(v);
      scene.frames.emplace_back(std::move(frame));
    }
  }
  finish_scene(scene, spec.name);
  return scene;
}

PipelineSpec test_pipeline(const std::string& behaviour) {
  const Registry& registry = Registry::instance();
  const bool optimized = behaviour == "good optimized";
  PipelineSpec spec;
  spec.label = behaviour;
  spec.base = behaviour;
  spec.builder = registry.ref(Role::builder, "test-builder", {{"behaviour", optimized ? "good" : behaviour}});
  if (optimized) spec.optimizers.assign(2, registry.ref(Role::optimizer, "test-optimizer"));
  return spec;
}

Plan test_plan(const std::vector<std::string>& behaviours) {
  Plan plan;
  plan.name = "test";
  plan.file = "test.yaml";
  plan.scenes.push_back({"strip", "strip", "strip", 0, 1, "strip", {}});
  for (const std::string& behaviour : behaviours) {
    plan.cells.push_back({0, plan.pipelines.size(), {}, {}});
    plan.pipelines.push_back(test_pipeline(behaviour));
  }
  return plan;
}

void add_traces(Plan& plan, const std::vector<std::string>& behaviours, bool workload_fails) {
  const Registry& registry = Registry::instance();
  plan.workloads.push_back({"down", "down", registry.ref(Role::workload, "test-workload", {{"fails", workload_fails}}), {}});
  for (const std::string& behaviour : behaviours) {
    plan.cells.push_back({0, 0, plan.tracers.size(), plan.workloads.size() - 1});
    plan.tracers.push_back({behaviour, behaviour, registry.ref(Role::tracer, "test-tracer", {{"behaviour", behaviour}}), {}});
  }
}

void add_animation(Plan& plan, std::size_t frames, const std::string& behaviour) {
  plan.animation = AnimationSpec{frames};
  for (SceneSpec& scene : plan.scenes) scene.name = "rising strip";
  for (PipelineSpec& pipeline : plan.pipelines) {
    pipeline.updater = Registry::instance().ref(Role::updater, "test-updater", {{"behaviour", behaviour}});
  }
}

void add_metric(Plan& plan, const std::string& behaviour) {
  plan.metrics.push_back(Registry::instance().ref(Role::metric, "test-metric", {{"behaviour", behaviour}}));
}

}  // namespace raystudy
