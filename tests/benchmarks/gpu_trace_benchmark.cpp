// Rays a second on a Vulkan device by its own clock, beside tracers on the processor with as many threads as it has, by the clock
// on the wall: every tracer of RAYSTUDY_BENCHMARK_TRACERS on the tree of sweep-sah, on every scene of RAYSTUDY_BENCHMARK_SCENES.
// Names are separated by commas.
//   RAYSTUDY_BENCHMARK_TRACERS='scalar,gpu,gpu(persistent=true)' RAYSTUDY_BENCHMARK_SCENES=sibenik-ogre,conference
//   gpu_trace_benchmark
//     --benchmark_enable_random_interleaving=true --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "harness/method/registry.h"
#include "harness/run/oracle.h"
#include "harness/scene/open.h"
#include "tests/benchmarks/method_text.h"

namespace raystudy {
namespace {

using benchmarks::Changes;
using benchmarks::method;
using benchmarks::split;

std::vector<std::string> named(const char* variable, const char* fallback) {
  const char* text = std::getenv(variable);
  return split(text != nullptr ? text : fallback, ',');
}

int threads() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

/// A scene, its tree and its rays.
struct Setup {
  Scene scene;
  std::unique_ptr<Accel> tree;
  std::map<std::string, RayBatch> batches;

  explicit Setup(const std::string& name) {
    const std::vector<std::string> parts = split(name, ':');
    scene = open_scene(parts[0], parts.size() > 1 ? std::stoll(parts[1]) : 80000);
    const Registry& registry = Registry::instance();
    tree = registry.create<Builder>(registry.ref(Role::builder, "sweep-sah"))->build(scene, {});
    ReferenceTracer reference(scene, threads());
    const WorkloadContext context{1, [&](auto rays, auto hits) { reference.trace(rays, hits, Query::closest_hit); }};
    const std::map<std::string, Changes> workloads{
        {"primary", {{"width", std::int64_t{512}}, {"height", std::int64_t{384}}}},
        {"random", {{"count", std::int64_t{100000}}}},
        {"ambient-occlusion", {{"width", std::int64_t{200}}, {"height", std::int64_t{150}}}}};
    for (const auto& [workload, changes] : workloads) {
      batches[workload] = registry.create<Workload>(registry.ref(Role::workload, workload, changes))->generate(scene, context);
    }
  }
};

void trace(benchmark::State& state, const Setup& setup, const std::string& tracer, const RayBatch& batch) {
  const auto session = Registry::instance()
                           .create<Tracer>(method(tracer, {Role::tracer}).second)
                           ->prepare(*setup.tree, setup.scene, threads(), batch.coherent);
  std::vector<Hit> hits(batch.rays.size());
  session->trace(batch.rays, hits, batch.query);  // compiles kernels
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    session->trace(batch.rays, hits, batch.query);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const DeviceTimes* device = session->device_times();
    state.SetIterationTime(device != nullptr ? device->seconds.value_or(seconds) : seconds);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(batch.rays.size()) * state.iterations());
  // 64 bytes an inner node, 40 a triangle.
  const TraceCounts counts = session->count(batch.rays, batch.query, {});
  const auto node_bytes = static_cast<double>(64 * counts.inner_nodes + 40 * counts.triangle_tests);
  state.counters["B/ray"] = sizeof(Ray) + sizeof(Hit) + node_bytes / static_cast<double>(batch.rays.size());
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  using namespace raystudy;
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    std::map<std::string, Setup> setups;
    for (const std::string& scene : named("RAYSTUDY_BENCHMARK_SCENES", "atrium:80000")) {
      const Setup& setup = setups.try_emplace(scene, scene).first->second;
      for (const auto& [workload, batch] : setup.batches) {
        for (const std::string& tracer : named("RAYSTUDY_BENCHMARK_TRACERS", "scalar,gpu,gpu(persistent=true)")) {
          benchmark::RegisterBenchmark(fmt::format("{} {} {}", scene, workload, tracer).c_str(), trace, std::cref(setup), tracer,
                                       std::cref(batch))
              ->Unit(benchmark::kMillisecond)
              ->UseManualTime();
        }
      }
    }
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
