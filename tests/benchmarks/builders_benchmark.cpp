// Building rate of the builders of binary trees. Scenes are named in RAYSTUDY_BENCHMARK_SCENES, separated by commas; NAME:COUNT
// is a procedural scene of COUNT triangles. Each is built on 1 and on 2 threads, with one triangle a leaf; and for a tracer:
// binned SAH with leaves up to 8 triangles and bvh8, beside Embree's medium quality.
//   RAYSTUDY_BENCHMARK_SCENES=sponza-crytek,terrain:1000000 builders_benchmark --benchmark_enable_random_interleaving=true
//     --benchmark_repetitions=9 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>

#include "harness/method/registry.h"
#include "harness/scene/open.h"

namespace {

using namespace raystudy;

void build(benchmark::State& state, const Scene& scene, const std::string& name, int threads) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name));
  BuildContext context;
  context.threads = threads;
  for (auto _ : state) benchmark::DoNotOptimize(builder->build(scene, context));
  state.counters["Mtri/s"] =
      benchmark::Counter(static_cast<double>(scene.triangles.size()) * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
  const auto accel = builder->build(scene, context);
  state.counters["cost"] = tree_cost(dynamic_cast<const Bvh2&>(*accel), context.cost);
}

/// A tree that fast tracers take: built and, with `encoder`, encoded.
void make(benchmark::State& state, const Scene& scene, const MethodRef& builder, const char* encoder, int threads) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  const auto build_with = registry.create<Builder>(builder);
  const auto encode_with = encoder != nullptr ? registry.create<Encoder>(registry.ref(Role::encoder, encoder)) : nullptr;
  for (auto _ : state) {
    std::unique_ptr<Accel> made = build_with->build(scene, context);
    if (encode_with) made = encode_with->encode(dynamic_cast<const Bvh2&>(*made), scene, context);
    benchmark::DoNotOptimize(made);
  }
}

void register_scene(std::string_view spec) {
  const std::size_t colon = spec.find(':');
  const std::int64_t triangles = colon == std::string_view::npos ? 0 : std::stoll(std::string(spec.substr(colon + 1)));
  const auto scene = std::make_shared<const Scene>(open_scene(spec.substr(0, colon), triangles));
  for (const char* name : {"sweep-sah", "binned-sah", "spatial-median", "object-median", "ploc"}) {
    for (const int threads : {1, 2}) {
      benchmark::RegisterBenchmark(fmt::format("{}/{}/threads:{}", spec, name, threads).c_str(),
                                   [scene, name, threads](benchmark::State& state) { build(state, *scene, name, threads); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MinTime(0.2);
    }
  }
  const Registry& registry = Registry::instance();
  const MethodRef binned =
      registry.ref(Role::builder, "binned-sah", {{"leaves", std::string("sah")}, {"max_leaf_triangles", std::int64_t{8}}});
  const MethodRef embree = registry.ref(Role::builder, "embree", {{"quality", std::string("medium")}});
  for (const int threads : {1, 2}) {
    const auto add = [&](const char* name, const MethodRef& builder, const char* encoder) {
      benchmark::RegisterBenchmark(
          fmt::format("{}/{}/threads:{}", spec, name, threads).c_str(),
          [scene, builder, encoder, threads](benchmark::State& state) { make(state, *scene, builder, encoder, threads); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MinTime(0.2);
    };
    add("binned-sah+bvh8", binned, "bvh8");
    add("binned-sah8", binned, nullptr);
    add("embree-medium", embree, nullptr);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const char* named = std::getenv("RAYSTUDY_BENCHMARK_SCENES");
    std::string_view scenes = named != nullptr ? named : "atrium:100000";
    while (!scenes.empty()) {
      const std::size_t comma = std::min(scenes.find(','), scenes.size());
      register_scene(scenes.substr(0, comma));
      scenes.remove_prefix(std::min(comma + 1, scenes.size()));
    }
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
