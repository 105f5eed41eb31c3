#include "methods/scalar/scalar_session.h"

#include <atomic>
#include <stdexcept>

#include "harness/accel/tree_height.h"
#include "harness/method/parallel_rays.h"
#include "harness/method/ray_counter.h"

namespace raystudy::scalar {

ScalarSession::ScalarSession(const Bvh2& bvh, const Scene& scene, int threads)
    : triangles_(bvh.triangles), empty_(bvh.empty()), threads_(threads) {
  if (empty_) return;
  const Bvh2Node& root = bvh.nodes[0];
  bounds_ = root.box;
  root_first_ = root.is_leaf() ? root.first : root.first / 2;
  root_count_ = root.count;
  stack_size_ = tree_height(bvh) + 1;

  pairs_.resize(bvh.nodes.size() / 2);
  // Pair 0 is the root and its padding, and is never tested as a pair.
  for (std::size_t i = 1; i < pairs_.size(); ++i) {
    const Bvh2Node& a = bvh.nodes[2 * i];
    const Bvh2Node& b = bvh.nodes[2 * i + 1];
    pairs_[i].boxes = {a.box, b.box};
    pairs_[i].first = {a.is_leaf() ? a.first : a.first / 2, b.is_leaf() ? b.first : b.first / 2};
    pairs_[i].count = {a.count, b.count};
  }
  packed_.reserve(bvh.triangles.size());
  for (const std::uint32_t t : bvh.triangles) {
    const Triangle& triangle = scene.triangles[t];
    packed_.emplace_back(scene.vertices[triangle[0]], scene.vertices[triangle[1]], scene.vertices[triangle[2]]);
  }
}

template <bool any, class Counter>
Hit ScalarSession::trace_one(const Ray& ray, Pending* const stack, Counter& counter) const {
  Hit hit;
  const ShearedRay sheared(ray);
  if (!sheared.valid) return hit;
  hit.t = ray.tmax;
  const SlabRay slabs(ray, bounds_);
  __m128 limits = slabs.limits(ray.tmin, ray.tmax);
  counter.boxes(1);
  const SlabHit root = test_boxes(slabs, SlabPair(bounds_, bounds_), limits);
  if (root.mask == 0) return {};

  Pending node{root_first_, root_count_, root.near[0]};
  Pending* top = stack;
  while (true) {
    if (node.count == 0) {
      counter.inner();
      counter.boxes(2);
      const NodePair& pair = pairs_[node.first];
      const SlabHit met = test_boxes(slabs, pair.boxes, limits);
      if (met.mask != 0) {
        // Of two, the nearer one next (the first where they tie); of one, that one.
        const std::size_t next = met.mask == 3 ? static_cast<std::size_t>(met.near[1] < met.near[0]) : met.mask >> 1;
        if (met.mask == 3) {
          const std::size_t later = 1 - next;
          *top++ = {pair.first[later], pair.count[later], met.near[later]};
        }
        node = {pair.first[next], pair.count[next], met.near[next]};
        continue;
      }
    } else {
      counter.leaf();
      bool nearer = false;
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        counter.triangles(1);
        TriangleHit found;
        if (!intersect(sheared, packed_[i], hit.t, found)) continue;
        const std::uint32_t triangle = triangles_[i];
        if (found.t == hit.t && hit.triangle < triangle) continue;
        hit = {found.t, triangle, found.u, found.v};
        if constexpr (any) return hit;
        nearer = true;
      }
      if (nearer) limits = slabs.limits(ray.tmin, hit.t);
    }
    const float farthest = slabs.scaled(hit.t);
    do {
      if (top == stack) return hit.is_hit() ? hit : Hit{};
      node = *--top;
    } while (node.near > farthest);
  }
}

template <class Counter, class Write>
Counter ScalarSession::trace_tile(std::span<const Ray> rays, Query query, Write&& write) const {
  Counter total;
  if (empty_) {
    for (std::size_t i = 0; i < rays.size(); ++i) write(i, Hit{}, total);
    return total;
  }
  std::vector<Pending> stack(stack_size_);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Hit hit =
        query == Query::any_hit ? trace_one<true>(rays[i], stack.data(), total) : trace_one<false>(rays[i], stack.data(), total);
    write(i, hit, total);
  }
  return total;
}

void ScalarSession::trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
  for_ray_tiles(rays.size(), threads_, [&](std::size_t begin, std::size_t end) {
    Hit* const out = hits.data() + begin;
    trace_tile<NoCounter>(rays.subspan(begin, end - begin), query,
                          [out](std::size_t i, const Hit& hit, const NoCounter&) { out[i] = hit; });
  });
}

TraceCounts ScalarSession::count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) {
  if (!steps.empty() && steps.size() != rays.size()) throw std::logic_error("as many step counts as rays are needed, or none");
  std::atomic<std::uint64_t> inner_nodes = 0;
  std::atomic<std::uint64_t> leaves = 0;
  std::atomic<std::uint64_t> box_tests = 0;
  std::atomic<std::uint64_t> triangle_tests = 0;
  for_ray_tiles(rays.size(), threads_, [&](std::size_t begin, std::size_t end) {
    std::uint64_t before = 0;
    const auto sum =
        trace_tile<RayCounter>(rays.subspan(begin, end - begin), query, [&](std::size_t i, const Hit&, const RayCounter& total) {
          const std::uint64_t now = total.counts.traversal_steps();
          if (!steps.empty()) steps[begin + i] = static_cast<std::uint32_t>(now - before);
          before = now;
        });
    inner_nodes += sum.counts.inner_nodes;
    leaves += sum.counts.leaves;
    box_tests += sum.counts.box_tests;
    triangle_tests += sum.counts.triangle_tests;
  });
  return {inner_nodes, leaves, box_tests, triangle_tests};
}

}  // namespace raystudy::scalar
