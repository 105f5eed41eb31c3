// Time and result of the optimizers from a sweep-SAH tree with one triangle a leaf, one thread: over the sizes of `atrium`, and
// on those scenes of the catalog that are at hand (RAYSTUDY_SCENES). Counters: the cost in % of the tree's before, passes, and
// the seconds until 85.5 %.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/open.h"

namespace raystudy {
namespace {

struct Input {
  Scene scene;
  Bvh2 bvh;
};

const Input& input(const std::string& name, std::int64_t triangles) {
  static std::map<std::pair<std::string, std::int64_t>, Input> inputs;
  const auto [at, is_new] = inputs.try_emplace({name, triangles});
  if (is_new) {
    at->second.scene = open_scene(name, triangles);
    const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, "sweep-sah"));
    at->second.bvh = dynamic_cast<Bvh2&>(*builder->build(at->second.scene, {}));
  }
  return at->second;
}

void optimize(benchmark::State& state, const std::string& optimizer, const std::string& name, std::int64_t triangles) {
  const Input& in = input(name, triangles);
  const auto method = Registry::instance().create<Optimizer>(Registry::instance().ref(Role::optimizer, optimizer));
  const double before = tree_cost(in.bvh, {});
  for (auto _ : state) {
    Bvh2 bvh = in.bvh;
    std::vector<CostSample> trace;
    BuildContext context;
    context.cost_trace = &trace;
    const auto start = std::chrono::steady_clock::now();
    method->optimize(bvh, in.scene, context);
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    state.counters["cost_%"] = 100 * tree_cost(bvh, {}) / before;
    state.counters["passes"] = static_cast<double>(trace.size() - 1);
    for (const CostSample& sample : trace) {
      if (sample.cost > 0.855 * before) continue;
      state.counters["s_to_85.5_%"] = sample.seconds;
      break;
    }
  }
  state.SetComplexityN(static_cast<std::int64_t>(in.scene.triangles.size()));
}

bool at_hand(const std::string& name) {
  try {
    (void)open_scene(name);
    return true;
  } catch (const SceneNotInstalled&) {
    return false;
  }
}

void register_all() {
  for (const char* optimizer : {"insertion", "rotation-hill-climbing", "rotation-annealing"}) {
    for (const char* scene : {"sibenik-ogre", "sponza-dabrovic", "conference", "sponza-crytek"}) {
      if (!at_hand(scene)) continue;
      benchmark::RegisterBenchmark(fmt::format("{}/{}", optimizer, scene).c_str(), optimize, optimizer, scene, 0)
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
  for (const std::int64_t triangles : {10'000, 30'000, 100'000, 300'000, 1'000'000}) {
    benchmark::RegisterBenchmark(fmt::format("insertion/atrium/{}", triangles).c_str(), optimize, "insertion", "atrium",
                                 triangles)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  raystudy::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
