// One kernel a kind of node and an instruction set.
#include "methods/wide/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/streams/kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "methods/streams/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::streams::HWY_NAMESPACE {

struct NoCounter {
  void begin(std::size_t, std::span<const std::uint32_t>) {}
  void inner(std::size_t) {}
  void leaf(std::size_t) {}
  void boxes(std::size_t) {}
  void triangles(std::size_t) {}
};

/// A node counts for each ray that goes into it.
struct RayCounter {
  TraceCounts counts;
  std::span<std::uint32_t> steps;
  std::size_t base = 0;
  std::span<const std::uint32_t> order;

  void begin(std::size_t block, std::span<const std::uint32_t> rays) {
    base = block;
    order = rays;
  }
  void inner(std::size_t ray) {
    ++counts.inner_nodes;
    step(ray);
  }
  void leaf(std::size_t ray) {
    ++counts.leaves;
    step(ray);
  }
  void boxes(std::size_t n) { counts.box_tests += n; }
  void triangles(std::size_t n) { counts.triangle_tests += n; }

 private:
  void step(std::size_t ray) {
    if (!steps.empty()) ++steps[base + order[ray]];
  }
};

template <class Node, class Counter>
void trace_all(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays, std::span<Hit> hits, Query query,
               Counter& counter) {
  const auto trace_in = [&](auto words) {
    constexpr std::size_t n = decltype(words)::value;
    if (query == Query::any_hit) {
      trace_streams<StreamTraversal<Node, n, true, Counter>>(tree, options, rays, hits, counter);
    } else {
      trace_streams<StreamTraversal<Node, n, false, Counter>>(tree, options, rays, hits, counter);
    }
  };
  if (options.size == 32) {
    trace_in(std::integral_constant<std::size_t, 1>());
  } else {
    trace_in(std::integral_constant<std::size_t, 2>());
  }
}

template <class Node>
void trace(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  NoCounter counter;
  trace_all<Node>(tree, options, rays, hits, query, counter);
}

template <class Node>
TraceCounts count(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays, Query query,
                  std::span<std::uint32_t> steps) {
  std::fill(steps.begin(), steps.end(), 0U);
  RayCounter counter{.counts = {}, .steps = steps, .base = 0, .order = {}};
  std::vector<Hit> hits(rays.size());
  trace_all<Node>(tree, options, rays, hits, query, counter);
  return counter.counts;
}

Functions kernel(const WideBvh& bvh) {
  return bvh.visit([](const auto& nodes) {
    using Node = std::remove_cvref_t<decltype(nodes[0])>;
    return Functions{trace<Node>, count<Node>};
  });
}

}  // namespace raystudy::streams::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raystudy::streams {

Kernel kernel_for(const WideBvh& bvh, wide::Simd simd, const StreamOptions& options) {
  constexpr std::array<Functions (*)(const WideBvh&), 3> kernels RAYSTUDY_OF_EACH(kernel);
  return {kernels[wide::instruction_set(simd)](bvh), options};
}

}  // namespace raystudy::streams

#endif
