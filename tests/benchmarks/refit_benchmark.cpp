// Refitting a tree in memory: how near it comes to what the machine can move. Each line gives bytes a second: of a copy of a
// large block those read and those written; of a refit the nodes read and written, and the positions and indices of the
// triangles' vertices read, each once; on a Vulkan device, where there is one, by its clock. Of terrain, whose tree has one
// triangle a leaf, from a builder and in other orders in memory.
//   refit_benchmark --benchmark_filter='copy|terrain' --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>

#include "harness/accel/node_order.h"
#include "harness/accel/refit.h"
#include "harness/base/parallel.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "methods/vulkan/device_refit.h"

namespace raystudy {
namespace {

struct Input {
  Scene scene;
  Bvh2 bvh;
};

Input& input(const std::string& order, std::int64_t triangles) {
  static std::map<std::pair<std::string, std::int64_t>, Input> inputs;
  const auto [at, is_new] = inputs.try_emplace({order, triangles});
  if (is_new) {
    at->second.scene = open_scene("terrain", triangles);
    const auto ref = Registry::instance().ref(Role::builder, "sweep-sah");
    BuildContext context;
    context.threads = 2;
    at->second.bvh = dynamic_cast<Bvh2&>(*Registry::instance().create<Builder>(ref)->build(at->second.scene, context));
    if (order != "built") arrange(at->second.bvh, node_order(order), Pages::huge);
  }
  return at->second;
}

std::int64_t bytes_of(const Input& in) {
  return static_cast<std::int64_t>(2 * in.bvh.nodes.size() * sizeof(Bvh2Node) + in.bvh.triangles.size() * sizeof(Triangle) +
                                   in.scene.vertices.size() * sizeof(Vec3));
}

/// Between two blocks many times as large as any last-level cache, in pages like those of nodes and the same in every repetition,
/// piece by piece, so that no thread is idle at the end. Some machines change their rate by half from one second to the next (a
/// virtual one: 36 to 41 and 68 to 72 GiB/s on two threads, with these blocks or others), so compare with the better of its
/// rates.
void copy(benchmark::State& state, int threads) {
  constexpr std::size_t bytes = std::size_t{1} << 28U;
  constexpr std::size_t piece = std::size_t{1} << 20U;
  static const AlignedVector<char> from(bytes, 1);
  static AlignedVector<char> to(bytes);
  for (auto _ : state) {
    with_threads(threads, [&] {
      parallel_for_blocks(bytes / piece, 1, threads, [&](std::size_t begin, std::size_t end) {
        std::memcpy(to.data() + begin * piece, from.data() + begin * piece, (end - begin) * piece);
      });
    });
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * 2 * bytes));
}

void refit(benchmark::State& state, RefitMethod method, int threads, const std::string& order, std::int64_t triangles) {
  Input& in = input(order, triangles);
  Refitter refitter(in.bvh, in.scene.triangles, method, threads);
  for (auto _ : state) {
    refitter.refit(in.bvh, in.scene.vertices);
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * bytes_of(in));
}

void refit_on_device(benchmark::State& state, gpu::DeviceRefitMethod method, std::int64_t triangles) {
  const Input& in = input("built", triangles);
  vulkan::Device& device = vulkan::Device::shared();
  const gpu::DeviceRefit refit(device, in.bvh, {in.scene.triangles.data(), in.scene.triangles.size()}, method);
  const vulkan::Buffer vertices(device, in.scene.vertices.size() * sizeof(Vec3));
  vulkan::upload(device, vertices.all(), std::span<const Vec3>(in.scene.vertices.data(), in.scene.vertices.size()));
  for (auto _ : state) {
    vulkan::Commands commands(device);
    commands.mark("refit");
    refit.record(commands, vertices.all());
    state.SetIterationTime(vulkan::total_seconds(commands.finish()));
  }
  state.SetBytesProcessed(state.iterations() * bytes_of(in));
}

void register_on_device() {
  if (vulkan::list_devices().empty()) return;
  for (const std::int64_t triangles : {100'000, 1'000'000}) {
    for (const auto& [name, method] :
         {std::pair("atomics", gpu::DeviceRefitMethod::atomics), std::pair("levels", gpu::DeviceRefitMethod::levels)}) {
      benchmark::RegisterBenchmark(("device-" + std::string(name) + "/terrain/" + std::to_string(triangles)).c_str(),
                                   refit_on_device, method, triangles)
          ->Unit(benchmark::kMillisecond)
          ->UseManualTime();
    }
  }
}

void register_all() {
  for (const int threads : {1, 2}) {
    benchmark::RegisterBenchmark(("copy/threads:" + std::to_string(threads)).c_str(), copy, threads)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
    for (const std::int64_t triangles : {100'000, 1'000'000}) {
      for (const char* order : {"built", "van-emde-boas"}) {
        for (const std::string& method : refit_method_names()) {
          if (method == "serial" && threads > 1) continue;
          const std::string name = method + "/terrain/" + std::to_string(triangles) + "/" + order;
          benchmark::RegisterBenchmark((name + "/threads:" + std::to_string(threads)).c_str(), refit, refit_method(method),
                                       threads, std::string(order), triangles)
              ->Unit(benchmark::kMillisecond)
              ->UseRealTime();
        }
      }
    }
  }
}

}  // namespace
}  // namespace raystudy

int main(int argc, char** argv) {
  raystudy::register_all();
  raystudy::register_on_device();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
