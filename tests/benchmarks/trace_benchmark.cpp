// Rays a second, one thread: every pipeline of RAYSTUDY_BENCHMARK_PIPELINES on every workload, on the scene that
// RAYSTUDY_BENCHMARK_SCENE names, NAME or NAME:TRIANGLES of a procedural one (default: sibenik-ogre where it is installed, else a
// procedural atrium of 80 000 triangles). Pipelines are separated by commas, and written BUILDER+OPTIMIZER…+ENCODER/TRACER; each
// of these is NAME or NAME(key=value;…).
//   RAYSTUDY_BENCHMARK_PIPELINES='sweep-sah+bvh8/wide,embree(quality=high)/embree(width=16)' trace_benchmark
//     --benchmark_enable_random_interleaving=true --benchmark_repetitions=5 --benchmark_report_aggregates_only=true

#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
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

Scene benchmark_scene() {
  if (const char* named = std::getenv("RAYSTUDY_BENCHMARK_SCENE")) {
    const std::vector<std::string> parts = split(named, ':');
    return open_scene(parts[0], parts.size() > 1 ? std::stoll(parts[1]) : 80000);
  }
  try {
    return open_scene("sibenik-ogre");
  } catch (const SceneNotInstalled&) {
    return open_scene("atrium", 80000);
  }
}

struct Setup {
  Scene scene = benchmark_scene();
  ReferenceTracer reference{scene, 1};
  std::map<std::string, RayBatch> batches;
  std::map<std::string, std::shared_ptr<Accel>> accels;

  Setup() {
    const Registry& registry = Registry::instance();
    const WorkloadContext context{1, [&](auto rays, auto hits) { reference.trace(rays, hits, Query::closest_hit); }};
    const std::map<std::string, Changes> workloads{
        {"primary", {}},
        {"random", {{"count", std::int64_t{300000}}}},
        {"ambient-occlusion", {{"width", std::int64_t{200}}, {"height", std::int64_t{150}}}}};
    for (const auto& [name, changes] : workloads) {
      batches[name] = registry.create<Workload>(registry.ref(Role::workload, name, changes))->generate(scene, context);
    }
  }

  std::shared_ptr<Accel> accel(const std::string& pipeline) {
    std::shared_ptr<Accel>& made = accels[pipeline];
    if (made) return made;
    const Registry& registry = Registry::instance();
    const BuildContext context;
    for (const std::string& stage : split(pipeline, '+')) {
      const auto [role, ref] = method(stage, {made ? Role::optimizer : Role::builder, Role::encoder});
      if (role == Role::builder) {
        made = registry.create<Builder>(ref)->build(scene, context);
      } else if (role == Role::optimizer) {
        registry.create<Optimizer>(ref)->optimize(dynamic_cast<Bvh2&>(*made), scene, context);
      } else {
        made = registry.create<Encoder>(ref)->encode(dynamic_cast<const Bvh2&>(*made), scene, context);
      }
    }
    return made;
  }
};

Setup& setup() {
  static Setup made;
  return made;
}

void trace(benchmark::State& state, const std::string& pipeline, const std::string& tracer, const std::string& workload) {
  const RayBatch& batch = setup().batches.at(workload);
  const auto accel = setup().accel(pipeline);
  const auto session = Registry::instance()
                           .create<Tracer>(method(tracer, {Role::tracer}).second)
                           ->prepare(*accel, setup().scene, 1, batch.coherent);
  std::vector<Hit> hits(batch.rays.size());
  for (auto _ : state) session->trace(batch.rays, hits, batch.query);
  state.SetItemsProcessed(static_cast<std::int64_t>(batch.rays.size()) * state.iterations());
  state.counters["B/tri"] = static_cast<double>(accel->bytes()) / static_cast<double>(setup().scene.triangles.size());
  if (!session->counts()) return;
  const TraceCounts counts = session->count(batch.rays, batch.query, {});
  const auto per_ray = [&](std::uint64_t n) { return static_cast<double>(n) / static_cast<double>(batch.rays.size()); };
  state.counters["inner"] = per_ray(counts.inner_nodes);
  state.counters["leaves"] = per_ray(counts.leaves);
  state.counters["tests"] = per_ray(counts.triangle_tests);
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  using raystudy::trace;
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const char* named = std::getenv("RAYSTUDY_BENCHMARK_PIPELINES");
    const std::string_view pipelines =
        named != nullptr ? named : "sweep-sah/scalar,sweep-sah+bvh8/wide,embree(quality=high)/embree";
    for (const std::string workload : {"primary", "random", "ambient-occlusion"}) {
      for (const std::string& pipeline : raystudy::benchmarks::split(pipelines, ',')) {
        const std::size_t slash = pipeline.rfind('/');
        benchmark::RegisterBenchmark((workload + " " + pipeline).c_str(), trace, pipeline.substr(0, slash),
                                     pipeline.substr(slash + 1), workload)
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
      }
    }
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
