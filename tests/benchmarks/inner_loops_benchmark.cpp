// The inner loops of builders, optimizers, encoders and tracers, each by itself, on data that stays in the near caches but where
// a size says otherwise: items (what the name counts) and bytes a second, one thread.
//   inner_loops_benchmark --benchmark_filter=box_test

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "harness/accel/tree_walk.h"
#include "harness/base/radix_sort.h"
#include "harness/geometry/slab.h"
#include "harness/geometry/watertight.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "methods/insertion/min_heap.h"
#include "methods/ploc/nearest.h"
#include "methods/topdown/binned_split.h"
#include "methods/topdown/sweep_orders.h"
#include "methods/wide/collapse.h"
#include "methods/wide/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy {
namespace {

namespace kernel = wide::HWY_NAMESPACE;
using Changes = std::map<std::string, ParamValue, std::less<>>;

const Scene& scene() {
  static const Scene made = open_scene("atrium", 80000);
  return made;
}

const Bvh2& tree() {
  static const auto made =
      Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, "sweep-sah"))->build(scene(), {});
  return dynamic_cast<const Bvh2&>(*made);
}

template <class Node>
const WideBvh& wide_tree() {
  static const auto made = [] {
    constexpr bool quantized = requires(const Node& n) { n.exponent; };
    const Registry& registry = Registry::instance();
    const Changes changes{{"boxes", std::string(quantized ? "8-bit" : "float")}};
    return registry.create<Encoder>(registry.ref(Role::encoder, "bvh" + std::to_string(Node::width), changes))
        ->encode(tree(), scene(), {});
  }();
  return dynamic_cast<const WideBvh&>(*made);
}

/// From anywhere in the scene to anywhere.
std::vector<Ray> rays(std::size_t n) {
  std::mt19937 random(1);
  const auto point = [&] {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const float share = static_cast<float>(random()) * 0x1p-32F;
      p[axis] = scene().bounds.lower[axis] + share * scene().bounds.extent()[axis];
    }
    return p;
  };
  std::vector<Ray> all;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 from = point();
    all.push_back({from, 0, normalized(point() - from), std::numeric_limits<float>::infinity()});
  }
  return all;
}

void per_pass(benchmark::State& state, std::size_t items, std::size_t bytes) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(items));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

constexpr std::size_t ray_count = 64;

void box_test_bvh2(benchmark::State& state) {
  std::vector<SlabPair> pairs;
  for_each_node(tree(), [&](const Bvh2Node& node, std::uint32_t) {
    if (node.is_leaf() || pairs.size() == 256) return;
    pairs.emplace_back(tree().nodes[node.first].box, tree().nodes[node.first + 1].box);
  });
  std::vector<SlabRay> slabs;
  for (const Ray& ray : rays(ray_count)) slabs.emplace_back(ray, scene().bounds);
  for (auto _ : state) {
    for (const SlabRay& ray : slabs) {
      const auto limits = ray.limits(0, std::numeric_limits<float>::infinity());
      for (const SlabPair& pair : pairs) benchmark::DoNotOptimize(test_boxes(ray, pair, limits));
    }
  }
  per_pass(state, 2 * ray_count * pairs.size(), ray_count * pairs.size() * sizeof(SlabPair));
}
BENCHMARK(box_test_bvh2);

template <class Node>
void box_test_wide(benchmark::State& state) {
  using D = kernel::FloatsOf<Node::width>;
  const D d;
  const WideBvh& bvh = wide_tree<Node>();
  const auto& all = std::get<WideBvh::NodeArray<Node>>(bvh.nodes);
  const std::size_t n = std::min<std::size_t>(all.size(), 64);
  const wide::Tree view(bvh);
  std::vector<wide::WideRay> made;
  for (const Ray& ray : rays(ray_count)) made.emplace_back(ray, view.slabs);
  for (auto _ : state) {
    for (const wide::WideRay& ray : made) {
      const kernel::SlabVectors<D> slabs(d, ray);
      const auto tmin = kernel::hn::Zero(d);
      const auto tmax = kernel::hn::Inf(d);
      for (std::size_t i = 0; i < n; ++i) {
        unsigned met = 0;
        for (std::size_t lane = 0; lane < Node::width; lane += kernel::hn::MaxLanes(d)) {
          met |= kernel::mask_bits(kernel::test_boxes(d, all[i], lane, slabs, tmin, tmax).met()) << lane;
        }
        benchmark::DoNotOptimize(met);
      }
    }
  }
  per_pass(state, ray_count * n * Node::width, ray_count * n * sizeof(Node));
}
BENCHMARK_TEMPLATE(box_test_wide, WideNode<4>);
BENCHMARK_TEMPLATE(box_test_wide, WideNode<8>);
BENCHMARK_TEMPLATE(box_test_wide, WideNode<16>);
BENCHMARK_TEMPLATE(box_test_wide, QuantizedNode<4>);
BENCHMARK_TEMPLATE(box_test_wide, QuantizedNode<8>);
BENCHMARK_TEMPLATE(box_test_wide, QuantizedNode<16>);

void triangle_test_scalar(benchmark::State& state) {
  std::vector<PackedTriangle> triangles;
  for (std::size_t i = 0; i < 256; ++i) {
    const Triangle& t = scene().triangles[i];
    triangles.emplace_back(scene().vertices[t[0]], scene().vertices[t[1]], scene().vertices[t[2]]);
  }
  std::vector<ShearedRay> sheared;
  for (const Ray& ray : rays(ray_count)) sheared.emplace_back(ray);
  for (auto _ : state) {
    for (const ShearedRay& ray : sheared) {
      for (const PackedTriangle& triangle : triangles) {
        TriangleHit hit;
        benchmark::DoNotOptimize(intersect(ray, triangle, std::numeric_limits<float>::infinity(), hit));
      }
    }
  }
  per_pass(state, ray_count * triangles.size(), ray_count * triangles.size() * sizeof(PackedTriangle));
}
BENCHMARK(triangle_test_scalar);

void triangle_test_wide(benchmark::State& state) {
  const kernel::FloatsOf<8> d;
  const WideBvh& bvh = wide_tree<WideNode<8>>();
  const wide::Tree view(bvh);
  std::vector<std::uint32_t> leaves;
  std::size_t triangles = 0;
  for_each_slot(bvh, [&](const Box&, std::uint32_t child) {
    if (!WideChild::is_leaf(child) || leaves.size() == 64) return;
    leaves.push_back(child);
    triangles += WideChild::count(child);
  });
  std::vector<wide::WideRay> made;
  for (const Ray& ray : rays(ray_count)) made.emplace_back(ray, view.slabs);
  for (auto _ : state) {
    for (const wide::WideRay& ray : made) {
      const kernel::ShearVectors<kernel::FloatsOf<8>> shear(d, ray);
      for (const std::uint32_t leaf : leaves) {
        Hit hit;
        hit.t = std::numeric_limits<float>::infinity();
        benchmark::DoNotOptimize(kernel::test_leaf<false>(d, view, leaf, ray, shear, 0, hit));
      }
    }
  }
  per_pass(state, ray_count * triangles, ray_count * triangles * 9 * sizeof(float));
}
BENCHMARK(triangle_test_wide);

/// Children that are met, of nodes where two to all of them are, put on the stack by distance.
template <class Node>
void node_sort(benchmark::State& state) {
  const Node& node = std::get<WideBvh::NodeArray<Node>>(wide_tree<Node>().nodes)[0];
  struct Met {
    unsigned bits;
    std::array<float, Node::width> near;
  };
  std::mt19937 random(1);
  std::vector<Met> all(1024);
  std::size_t items = 0;
  for (Met& met : all) {
    const auto mask = [&] { return static_cast<unsigned>(random()) & ((1U << Node::width) - 1); };
    do met.bits = mask();
    while (std::popcount(met.bits) < 2);
    for (float& near : met.near) near = static_cast<float>(random());
    items += static_cast<std::size_t>(std::popcount(met.bits));
  }
  std::array<kernel::Pending, Node::width> stack;
  for (auto _ : state) {
    for (const Met& met : all) {
      kernel::Pending* top = stack.data();
      benchmark::DoNotOptimize(kernel::push_by_distance(node, met.bits, met.near, top));
      benchmark::DoNotOptimize(top);
      benchmark::ClobberMemory();
    }
  }
  per_pass(state, items, items * sizeof(kernel::Pending));
}
BENCHMARK_TEMPLATE(node_sort, WideNode<4>);
BENCHMARK_TEMPLATE(node_sort, WideNode<8>);
BENCHMARK_TEMPLATE(node_sort, WideNode<16>);

/// Steps of the insertion search: the least is replaced by one that is not less, and another put in and taken out.
void insertion_heap(benchmark::State& state) {
  const auto size = static_cast<std::size_t>(state.range(0));
  std::mt19937_64 random(1);
  std::vector<std::uint64_t> steps(4096);
  for (auto& step : steps) step = random() >> 44U;
  insertion::MinHeap heap;
  for (std::size_t i = 0; i < size; ++i) heap.push(steps[i % steps.size()]);
  for (auto _ : state) {
    for (const std::uint64_t step : steps) {
      const std::uint64_t least = heap.replace_top(heap.top() + step);
      heap.push(least + step);
      benchmark::DoNotOptimize(heap.pop());
    }
  }
  per_pass(state, 3 * steps.size(), 3 * steps.size() * sizeof(std::uint64_t));
}
BENCHMARK(insertion_heap)->Arg(16)->Arg(128)->Arg(1024);

using Records = AlignedVector<topdown::BoxRecord>;

Records records(std::size_t n) {
  Records all(scene().triangles.size());
  topdown::fill_records(scene(), 1, all);
  all.resize(n);
  return all;
}

void bounds(benchmark::State& state) {
  const Records some = records(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(topdown::bounds_of(some, 1).box.box());
  per_pass(state, some.size(), some.size() * sizeof(topdown::BoxRecord));
}
BENCHMARK(bounds)->Arg(64)->Arg(512)->Arg(50000);

void binning(benchmark::State& state) {
  const Records some = records(static_cast<std::size_t>(state.range(0)));
  const SurfaceArea area;
  topdown::BinnedSplitter splitter(area, 32, 1);
  const topdown::NodeBounds around = topdown::bounds_of(some, 1);
  for (auto _ : state) benchmark::DoNotOptimize(splitter.split(some, around));
  per_pass(state, some.size(), some.size() * sizeof(topdown::BoxRecord));
}
BENCHMARK(binning)->Arg(64)->Arg(512)->Arg(50000);

void partition(benchmark::State& state) {
  const Records some = records(static_cast<std::size_t>(state.range(0)));
  const SurfaceArea area;
  topdown::BinnedSplitter splitter(area, 32, 1);
  const std::span<const topdown::BoxRecord> all(some);
  const topdown::Split split = splitter.split(all, topdown::bounds_of(all, 1));
  Records out(some.size());
  for (auto _ : state) {
    topdown::divide(all, split.plane, out.data(), out.data() + split.left);
    benchmark::ClobberMemory();
  }
  per_pass(state, some.size(), 2 * some.size() * sizeof(topdown::BoxRecord));
}
BENCHMARK(partition)->Arg(64)->Arg(512)->Arg(50000);

/// Nodes of the binary tree, of which the whole is in no near cache.
template <int W>
void collapse(benchmark::State& state) {
  const SurfaceArea area;
  for (auto _ : state) benchmark::DoNotOptimize(wide::OptimalCollapse<W>(tree(), area, {}).cost());
  per_pass(state, tree().nodes.size(), tree().nodes.size() * sizeof(Bvh2Node));
}
BENCHMARK_TEMPLATE(collapse, 4);
BENCHMARK_TEMPLATE(collapse, 8);
BENCHMARK_TEMPLATE(collapse, 16);

/// Clusters whose nearest neighbours are found.
void nearest_neighbour(benchmark::State& state) {
  const auto radius = static_cast<int>(state.range(0));
  const Records some = records(1024);
  std::vector<float> room(ploc::Clusters::room_for(some.size(), static_cast<std::size_t>(radius)));
  ploc::Clusters clusters(some.size(), static_cast<std::size_t>(radius), room);
  for (std::size_t i = 0; i < some.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      clusters.row(axis)[i] = some[i].lower[axis];
      clusters.row(3 + axis)[i] = some[i].negated_upper[axis];
    }
  }
  clusters.set_count(some.size());
  std::vector<std::uint32_t> nearest(some.size() + ploc::search_group);
  for (auto _ : state) {
    ploc::find_nearest(SurfaceArea(), clusters, 0, some.size(), radius, nearest.data());
    benchmark::ClobberMemory();
  }
  per_pass(state, some.size(), some.size() * 6 * sizeof(float));
}
BENCHMARK(nearest_neighbour)->Arg(8)->Arg(14)->Arg(100);

/// Keys of 60 bits.
void sort(benchmark::State& state) {
  const auto n = static_cast<std::size_t>(state.range(0));
  std::mt19937_64 random(1);
  std::vector<Keyed<std::uint64_t>> keys(n);
  for (std::size_t i = 0; i < n; ++i) keys[i] = {random() >> 4U, static_cast<std::uint32_t>(i)};
  std::vector<Keyed<std::uint64_t>> items(n);
  std::vector<Keyed<std::uint64_t>> other(n);
  std::vector<std::uint32_t> order(n);
  for (auto _ : state) {
    items = keys;
    radix_sort(items.data(), other.data(), n, 60, 1,
               [&order](std::size_t place, const Keyed<std::uint64_t>& item) { order[place] = item.index; });
    benchmark::ClobberMemory();
  }
  per_pass(state, n, n * sizeof(keys[0]));
}
BENCHMARK(sort)->Arg(100000)->Arg(1000000);

}  // namespace
}  // namespace raystudy
HWY_AFTER_NAMESPACE();

BENCHMARK_MAIN();
