// Rays a second of the scalar tracer on a sweep-sah tree beside Embree, one thread. RAYSTUDY_BENCHMARK_SCENE names the scene
// (default: sibenik-ogre where it is installed, else a procedural atrium of 80 000 triangles).

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <map>

#include "harness/method/registry.h"
#include "harness/run/oracle.h"
#include "harness/scene/open.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Scene benchmark_scene() {
  if (const char* name = std::getenv("RAYSTUDY_BENCHMARK_SCENE")) return open_scene(name, 80000);
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
  std::map<std::string, std::unique_ptr<Accel>> accels;

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
    const auto build = [&](const std::string& label, const std::string& name, const Changes& changes) {
      accels[label] = registry.create<Builder>(registry.ref(Role::builder, name, changes))->build(scene, {});
    };
    build("sweep-sah", "sweep-sah", {});
    build("embree", "embree", {});
    build("embree-robust", "embree", {{"robust", true}});
  }
};

Setup& setup() {
  static Setup made;
  return made;
}

void trace(benchmark::State& state, const std::string& accel, const std::string& tracer, const Changes& changes,
           const std::string& workload) {
  const RayBatch& batch = setup().batches.at(workload);
  const Registry& registry = Registry::instance();
  const auto session = registry.create<Tracer>(registry.ref(Role::tracer, tracer, changes))
                           ->prepare(*setup().accels.at(accel), setup().scene, 1, batch.coherent);
  std::vector<Hit> hits(batch.rays.size());
  for (auto _ : state) session->trace(batch.rays, hits, batch.query);
  state.SetItemsProcessed(static_cast<std::int64_t>(batch.rays.size()) * state.iterations());
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  using raystudy::trace;
  for (const std::string workload : {"primary", "random", "ambient-occlusion"}) {
    const auto add = [&](const std::string& accel, const std::string& tracer, const raystudy::Changes& changes,
                         const char* label) {
      benchmark::RegisterBenchmark((workload + "/" + accel + "/" + label).c_str(), trace, accel, tracer, changes, workload)
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime();
    };
    add("sweep-sah", "scalar", {}, "scalar");
    add("embree", "embree", {}, "single");
    add("embree", "embree", {{"width", std::string("16")}}, "packets-16");
    add("embree-robust", "embree", {}, "single");
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
