// Sorts and builders on a Vulkan device, by its own clock, with the time of each part of a build beside them; builders on the
// processor by the clock on the wall. RAYSTUDY_BENCHMARK_SCENES and RAYSTUDY_BENCHMARK_BUILDERS name others.
//   RAYSTUDY_BENCHMARK_SCENES=terrain:1000000 gpu_benchmark --benchmark_filter=terrain --benchmark_repetitions=9
//     --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "harness/vulkan/device.h"
#include "methods/vulkan/radix_sort.h"
#include "tests/benchmarks/method_text.h"

namespace raystudy::gpu {
namespace {

using vulkan::Device;

constexpr const char* builders =
    "gpu-lbvh,gpu-lbvh(construction=apetrei),gpu-lbvh(morton_bits=63),gpu-hlbvh(split=median),gpu-hlbvh,gpu-ploc,ploc,lbvh,hlbvh("
    "split=median),"
    "hlbvh";

void sort(benchmark::State& state, std::uint32_t bits) {
  Device& device = Device::shared();
  const auto n = static_cast<std::uint32_t>(state.range(0));
  const std::size_t column = n * sizeof(std::uint32_t);
  const RadixSort radix(device, 0, bits);
  vulkan::Arena arena(device, vulkan::Arena::bytes_for({column, column, column, column, column, column, radix.room_for(n)}));
  const SortItems items{arena.take(column), arena.take(column), arena.take(column)};
  const SortItems other{arena.take(column), arena.take(column), arena.take(column)};
  const vulkan::Slice room = arena.take(radix.room_for(n));
  std::mt19937 random(1);
  std::vector<std::uint32_t> words(n);
  for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random()) & 0x3fffffffU;
  vulkan::upload(device, items.high, std::span<const std::uint32_t>(words));
  for (auto _ : state) {
    vulkan::upload(device, items.low, std::span<const std::uint32_t>(words));
    vulkan::Commands commands(device);
    commands.mark("sort");
    static_cast<void>(radix.record(commands, items, other, n, room));
    state.SetIterationTime(vulkan::total_seconds(commands.finish()));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * n));
}

/// The time of a build by the device's clock, and that of its parts in milliseconds.
void build(benchmark::State& state, const Scene& scene, const std::string& text) {
  const auto builder = Registry::instance().create<Builder>(benchmarks::method(text, {Role::builder}).second);
  DeviceTimes times;
  BuildContext context;
  context.device = &times;
  std::map<std::string, double> parts;
  static_cast<void>(builder->build(scene, context));  // compiles the kernels
  for (auto _ : state) {
    static_cast<void>(builder->build(scene, context));
    state.SetIterationTime(times.seconds.value_or(0));
    for (const DeviceTimes::Part& part : times.parts) parts[part.name] += part.seconds * 1e3;
  }
  for (const auto& [name, milliseconds] : parts) state.counters[name] = {milliseconds, benchmark::Counter::kAvgIterations};
  state.counters["bytes/triangle"] = static_cast<double>(times.peak_bytes) / static_cast<double>(scene.triangles.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scene.triangles.size()));
}

/// A builder on the processor, for comparison.
void build_on_threads(benchmark::State& state, const Scene& scene, const std::string& text, int threads) {
  const auto builder = Registry::instance().create<Builder>(benchmarks::method(text, {Role::builder}).second);
  BuildContext context;
  context.threads = threads;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    const auto accel = builder->build(scene, context);
    state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scene.triangles.size()));
}

std::string setting(const char* name, const char* fallback) {
  const char* value = std::getenv(name);
  return value != nullptr ? value : fallback;
}

void register_all() {
  for (const std::uint32_t bits : {30U, 63U}) {
    benchmark::RegisterBenchmark(fmt::format("sort/{}", bits).c_str(), sort, bits)
        ->RangeMultiplier(10)
        ->Range(10'000, 1'000'000)
        ->Unit(benchmark::kMillisecond)
        ->UseManualTime();
  }
  for (const std::string& spec : benchmarks::split(setting("RAYSTUDY_BENCHMARK_SCENES", "terrain:100000"), ',')) {
    const std::string name = spec.substr(0, spec.find(':'));
    const std::int64_t triangles = name == spec ? 0 : std::stoll(spec.substr(name.size() + 1));
    const auto scene = std::make_shared<const Scene>(open_scene(name, triangles));
    for (const std::string& text : benchmarks::split(setting("RAYSTUDY_BENCHMARK_BUILDERS", builders), ',')) {
      const std::string label = fmt::format("{}/{}", spec, text);
      if (text.starts_with("gpu-")) {
        benchmark::RegisterBenchmark(label.c_str(), [scene, text](benchmark::State& state) { build(state, *scene, text); })
            ->Unit(benchmark::kMillisecond)
            ->UseManualTime();
        continue;
      }
      for (const int threads : {1, 2}) {
        benchmark::RegisterBenchmark(
            fmt::format("{}/threads:{}", label, threads).c_str(),
            [scene, text, threads](benchmark::State& state) { build_on_threads(state, *scene, text, threads); })
            ->Unit(benchmark::kMillisecond)
            ->UseManualTime();
      }
    }
  }
}

}  // namespace
}  // namespace raystudy::gpu

int main(int argc, char** argv) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    raystudy::gpu::register_all();
    benchmark::RunSpecifiedBenchmarks();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
