// Building rate. Scenes are named in RAYSTUDY_BENCHMARK_SCENES, separated by commas; NAME:COUNT is a procedural scene of COUNT
// triangles. RAYSTUDY_BENCHMARK_BUILDERS names what is built, separated by commas and written BUILDER or BUILDER+ENCODER, each of
// them NAME or NAME(key=value;…). Each is built on 1 and on 2 threads; of binary trees the cost and the references a triangle are
// given.
//   RAYSTUDY_BENCHMARK_SCENES=sponza-crytek,terrain:1000000 builders_benchmark --benchmark_enable_random_interleaving=true
//     --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "tests/benchmarks/method_text.h"

namespace {

using namespace raystudy;

/// Builds, and encodes what was built where the text says so.
std::unique_ptr<Accel> made(const Scene& scene, const std::vector<std::string>& stages, const BuildContext& context) {
  const Registry& registry = Registry::instance();
  auto accel = registry.create<Builder>(benchmarks::method(stages.front(), {Role::builder}).second)->build(scene, context);
  if (stages.size() == 1) return accel;
  return registry.create<Encoder>(benchmarks::method(stages[1], {Role::encoder}).second)
      ->encode(dynamic_cast<const Bvh2&>(*accel), scene, context);
}

void build(benchmark::State& state, const Scene& scene, const std::string& text, int threads) {
  const std::vector<std::string> stages = benchmarks::split(text, '+');
  BuildContext context;
  context.threads = threads;
  for (auto _ : state) benchmark::DoNotOptimize(made(scene, stages, context));
  const auto triangles = static_cast<double>(scene.triangles.size());
  state.counters["Mtri/s"] = benchmark::Counter(triangles * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
  const auto accel = made(scene, {stages.front()}, context);
  if (const auto* bvh = dynamic_cast<const Bvh2*>(accel.get())) {
    state.counters["cost"] = tree_cost(*bvh, context.cost);
    state.counters["references"] = static_cast<double>(bvh->triangles.size()) / triangles;
  }
}

void register_scene(std::string_view spec, std::string_view builders) {
  const std::size_t colon = spec.find(':');
  const std::int64_t triangles = colon == std::string_view::npos ? 0 : std::stoll(std::string(spec.substr(colon + 1)));
  const auto scene = std::make_shared<const Scene>(open_scene(spec.substr(0, colon), triangles));
  for (const std::string& text : benchmarks::split(builders, ',')) {
    for (const int threads : {1, 2}) {
      benchmark::RegisterBenchmark(fmt::format("{}/{}/threads:{}", spec, text, threads).c_str(),
                                   [scene, text, threads](benchmark::State& state) { build(state, *scene, text, threads); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MinTime(0.2);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const char* named = std::getenv("RAYSTUDY_BENCHMARK_SCENES");
    const char* builders = std::getenv("RAYSTUDY_BENCHMARK_BUILDERS");
    for (const std::string& scene : benchmarks::split(named != nullptr ? named : "atrium:100000", ',')) {
      register_scene(scene,
                     builders != nullptr
                         ? builders
                         : "sweep-sah,binned-sah,sbvh,ploc,spatial-median,object-median,binned-sah(leaves=sah)+bvh8,embree");
    }
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
