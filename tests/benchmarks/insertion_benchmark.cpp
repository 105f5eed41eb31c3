// Time and result of the optimizers from a sweep-SAH tree with one triangle a leaf: over the sizes of `atrium`, and on those
// scenes of the catalog that are at hand (RAYSTUDY_SCENES). Counters: the cost in % of the tree's before, samples of the cost
// over time, the milliseconds until 85.5 %, and those until the cost with which `insertion` ends.
//   insertion_benchmark --cost_over_time [SCENE]
// prints the least cost after so many milliseconds instead, of the median of five runs in turn.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/open.h"

namespace raystudy {
namespace {

constexpr std::array catalog_scenes{"sibenik-ogre", "sponza-dabrovic", "conference", "sponza-crytek", "dragon"};

struct Input {
  Scene scene;
  Bvh2 bvh;
};

struct Run {
  double seconds = 0;
  std::vector<CostSample> trace;
  double cost = 0;
};

std::unique_ptr<Optimizer> make(const std::string& optimizer) {
  return Registry::instance().create<Optimizer>(Registry::instance().ref(Role::optimizer, optimizer));
}

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

Run run(const Optimizer& method, const Input& in, int threads) {
  Bvh2 bvh = in.bvh;
  Run result;
  BuildContext context;
  context.threads = threads;
  context.cost_trace = &result.trace;
  const auto start = std::chrono::steady_clock::now();
  method.optimize(bvh, in.scene, context);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.cost = tree_cost(bvh, {});
  return result;
}

/// The cost with which `insertion` ends on one thread.
double insertions_end(const std::string& name, std::int64_t triangles) {
  static std::map<std::pair<std::string, std::int64_t>, double> ends;
  const auto [at, is_new] = ends.try_emplace({name, triangles});
  if (is_new) at->second = run(*make("insertion"), input(name, triangles), 1).cost;
  return at->second;
}

/// Infinite where the cost never fell that low.
double milliseconds_to(const std::vector<CostSample>& trace, double cost) {
  for (const CostSample& sample : trace) {
    if (sample.cost <= cost) return 1e3 * sample.seconds;
  }
  return std::numeric_limits<double>::infinity();
}

void optimize(benchmark::State& state, const std::string& optimizer, int threads, const std::string& name,
              std::int64_t triangles) {
  const Input& in = input(name, triangles);
  const auto method = make(optimizer);
  const double before = tree_cost(in.bvh, {});
  for (auto _ : state) {
    const Run result = run(*method, in, threads);
    state.SetIterationTime(result.seconds);
    state.counters["cost_%"] = 100 * result.cost / before;
    state.counters["samples"] = static_cast<double>(result.trace.size() - 1);
    state.counters["ms_to_85.5_%"] = milliseconds_to(result.trace, 0.855 * before);
    state.counters["ms_to_insertion's_end"] = milliseconds_to(result.trace, insertions_end(name, triangles));
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

void add(const std::string& optimizer, int threads, const std::string& scene, std::int64_t triangles) {
  const std::string size = triangles > 0 ? fmt::format("/{}", triangles) : "";
  benchmark::RegisterBenchmark(fmt::format("{}/{}{}/threads:{}", optimizer, scene, size, threads).c_str(), optimize, optimizer,
                               threads, scene, triangles)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond);
}

void register_all() {
  for (const char* scene : catalog_scenes) {
    if (!at_hand(scene)) continue;
    for (const char* optimizer : {"insertion", "rotation-hill-climbing", "rotation-annealing"}) add(optimizer, 1, scene, 0);
    for (const int threads : {1, 2}) add("insertion-parallel", threads, scene, 0);
  }
  for (const std::int64_t triangles : {10'000, 30'000, 100'000, 300'000, 1'000'000}) {
    add("insertion", 1, "atrium", triangles);
    for (const int threads : {1, 2}) add("insertion-parallel", threads, "atrium", triangles);
  }
}

void print_cost_over_time(const std::string& scene) {
  struct Series {
    std::string optimizer;
    int threads = 1;
    std::vector<Run> runs{};
  };
  std::vector<Series> all{{"insertion", 1}, {"insertion-parallel", 1}, {"insertion-parallel", 2}};
  for (int i = 0; i < 5; ++i) {
    for (Series& s : all) s.runs.push_back(run(*make(s.optimizer), input(scene, 0), s.threads));
  }
  fmt::print("{}, cost {:.2f} before\n{:>8}", scene, tree_cost(input(scene, 0).bvh, {}), "ms");
  for (Series& s : all) {
    std::sort(s.runs.begin(), s.runs.end(), [](const Run& a, const Run& b) { return a.seconds < b.seconds; });
    fmt::print("{:>22}", fmt::format("{} x{}", s.optimizer, s.threads));
  }
  for (const int ms : {5, 10, 15, 20, 30, 40, 50, 70, 100, 150, 200, 300, 500, 1000, 1500, 2000, 3000, 5000}) {
    fmt::print("\n{:>8}", ms);
    for (const Series& s : all) {
      double least = std::numeric_limits<double>::infinity();
      for (const CostSample& sample : s.runs[2].trace) {
        if (1e3 * sample.seconds <= ms) least = std::min(least, sample.cost);
      }
      fmt::print("{:>22.2f}", least);
    }
  }
  fmt::print("\n{:>8}", "begin");
  for (const Series& s : all) fmt::print("{:>22}", fmt::format("@ {:.1f}", 1e3 * s.runs[2].trace.front().seconds));
  fmt::print("\n{:>8}", fmt::format("{:.2f}", insertions_end(scene, 0)));
  for (const Series& s : all) fmt::print("{:>22}", fmt::format("@ {:.1f}", milliseconds_to(s.runs[2].trace, insertions_end(scene, 0))));
  fmt::print("\n{:>8}", "end");
  for (const Series& s : all) fmt::print("{:>22}", fmt::format("{:.2f} @ {:.0f}", s.runs[2].cost, 1e3 * s.runs[2].seconds));
  fmt::print("\n\n");
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "--cost_over_time") == 0) {
    const std::string wanted = argc > 2 ? argv[2] : "";
    for (const std::string scene : raystudy::catalog_scenes) {
      if (scene.find(wanted) != std::string::npos && raystudy::at_hand(scene)) raystudy::print_cost_over_time(scene);
    }
    return 0;
  }
  raystudy::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
