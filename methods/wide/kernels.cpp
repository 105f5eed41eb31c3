// One kernel a kind of node and an instruction set.
#include "methods/wide/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/wide/kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "harness/method/ray_counter.h"
#include "methods/wide/in_flight-inl.h"
#include "methods/wide/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::wide::HWY_NAMESPACE {

template <class Node>
void trace(const Tree& tree, std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  NoCounter counter;
  trace_rays<Node>(tree, rays, query, counter, [&](std::size_t i, const Hit& hit) { hits[i] = hit; });
}

template <class Node>
TraceCounts count(const Tree& tree, std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) {
  RayCounter counter;
  std::uint64_t before = 0;
  trace_rays<Node>(tree, rays, query, counter, [&](std::size_t i, const Hit&) {
    const std::uint64_t now = counter.counts.traversal_steps();
    if (!steps.empty()) steps[i] = static_cast<std::uint32_t>(now - before);
    before = now;
  });
  return counter.counts;
}

constexpr std::size_t most_in_flight = 32;

template <class Node>
void trace_many(const Tree& tree, std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  const auto write = [&](std::size_t i, const Hit& hit, const NoCounter&) { hits[i] = hit; };
  if (query == Query::any_hit) {
    RaysInFlight<Node, true, NoCounter>(tree, rays, most_in_flight).run(write);
  } else {
    RaysInFlight<Node, false, NoCounter>(tree, rays, most_in_flight).run(write);
  }
}

template <class Node>
TraceCounts count_many(const Tree& tree, std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) {
  TraceCounts sum;
  const auto write = [&](std::size_t i, const Hit&, const RayCounter& counter) {
    sum.inner_nodes += counter.counts.inner_nodes;
    sum.leaves += counter.counts.leaves;
    sum.box_tests += counter.counts.box_tests;
    sum.triangle_tests += counter.counts.triangle_tests;
    if (!steps.empty()) steps[i] = static_cast<std::uint32_t>(counter.counts.traversal_steps());
  };
  if (query == Query::any_hit) {
    RaysInFlight<Node, true, RayCounter>(tree, rays, most_in_flight).run(write);
  } else {
    RaysInFlight<Node, false, RayCounter>(tree, rays, most_in_flight).run(write);
  }
  return sum;
}

Kernel kernel(const WideBvh& bvh, Schedule schedule) {
  return bvh.visit([schedule](const auto& nodes) {
    using Node = std::remove_cvref_t<decltype(nodes[0])>;
    return schedule == Schedule::one_by_one ? Kernel{trace<Node>, count<Node>} : Kernel{trace_many<Node>, count_many<Node>};
  });
}

}  // namespace raystudy::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>

#include "harness/base/error.h"

namespace raystudy::wide {
namespace {

std::size_t node_size(const WideBvh& bvh) {
  return bvh.visit([](const auto& all) { return sizeof(all[0]); });
}

}  // namespace

Tree::Tree(const WideBvh& bvh)
    : nodes(bvh.visit([](const auto& all) { return static_cast<const void*>(all.data()); })),
      corners(bvh.corners.data()),
      triangles(bvh.triangles.data()),
      bounds(bvh.bounds),
      slabs(bvh.bounds),
      height(bvh.height),
      first_lines_{
          {{static_cast<const char*>(nodes), node_size(bvh)}, {reinterpret_cast<const char*>(corners), 9 * sizeof(float)}}},
      last_line_{{{static_cast<const char*>(nodes) + std::min<std::size_t>(256, node_size(bvh) - 1), node_size(bvh)},
                  {reinterpret_cast<const char*>(triangles), sizeof(std::uint32_t)}}} {}

bool finish_triangle(const float* rows, std::uint32_t n, std::uint32_t i, std::uint32_t triangle, const TriangleRay& ray,
                     float tmin, Hit& hit) {
  std::array<float, 3> x{};
  std::array<float, 3> y{};
  std::array<float, 3> z{};
  for (int corner = 0; corner < 3; ++corner) {
    const auto c = static_cast<std::size_t>(corner);
    const auto at = [&](int axis) { return rows[std::size_t{n} * static_cast<std::size_t>(3 * axis + corner) + i]; };
    z[c] = at(ray.along) - ray.origin[2];
    x[c] = (at(ray.across) - ray.origin[0]) - ray.shear_across * z[c];
    y[c] = (at(ray.up) - ray.origin[1]) - ray.shear_up * z[c];
  }
  TriangleHit found;
  if (!finish_test(x.data(), y.data(), z.data(), tmin, static_cast<double>(ray.direction_along), hit.t, found)) return false;
  if (found.t == hit.t && hit.triangle < triangle) return false;
  hit = {found.t, triangle, found.u, found.v};
  return true;
}

Schedule best_schedule(bool coherent, std::size_t bytes) {
  constexpr std::size_t large = std::size_t{16} << 20U;
  return coherent && bytes < large ? Schedule::one_by_one : Schedule::in_turns;
}

std::size_t instruction_set(Simd simd) {
  // Asked once: CPUID ends in the hypervisor of a virtual machine, tens of microseconds a time.
  static const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
  if (simd == Simd::best && (usable & HWY_AVX3) != 0) return 0;
  if ((usable & HWY_AVX2) != 0) return 1;
  if (simd == Simd::avx2) throw Error("this processor has no AVX2; expected simd: auto");
  if ((usable & HWY_SSE4) == 0) throw Error("this processor lacks the AVX2 that Raystudy was built for");
  return 2;
}

std::string_view best_simd() {
  constexpr std::array<std::string_view, 3> names{"AVX-512", "AVX2", "SSE4"};
  return names[instruction_set(Simd::best)];
}

Kernel kernel_for(const WideBvh& bvh, Schedule schedule, Simd simd) {
  constexpr std::array<Kernel (*)(const WideBvh&, Schedule), 3> kernels RAYSTUDY_OF_EACH(kernel);
  return kernels[instruction_set(simd)](bvh, schedule);
}

}  // namespace raystudy::wide

#endif
