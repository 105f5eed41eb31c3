// One kernel a kind of node and an instruction set.
#include "methods/wide/targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "methods/packets/kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include "methods/packets/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {

struct NoCounter {
  void begin(const PacketRays&) {}
  template <class Group>
  void inner(const Group*, GroupRange) {}
  void leaf(std::size_t, unsigned, std::uint32_t) {}
  void boxes(std::size_t) {}
};

/// A node counts for each ray that goes into it with its packet: for those of the groups in range at an inner node, for those
/// that meet its box at a leaf.
template <std::size_t lanes>
struct RayCounter {
  TraceCounts counts;
  std::span<std::uint32_t> steps;
  PacketRays which;

  void begin(const PacketRays& rays) { which = rays; }
  template <class Group>
  void inner(const Group* groups, GroupRange range) {
    for (std::size_t g = range.first; g <= range.last; ++g) step(g, groups[g].active, counts.inner_nodes);
  }
  void leaf(std::size_t g, unsigned rays, std::uint32_t triangles) {
    step(g, rays, counts.leaves);
    counts.triangle_tests += std::uint64_t{triangles} * static_cast<unsigned>(std::popcount(rays));
  }
  void boxes(std::size_t n) { counts.box_tests += n; }

 private:
  void step(std::size_t g, unsigned rays, std::uint64_t& sum) {
    sum += static_cast<unsigned>(std::popcount(rays));
    if (steps.empty()) return;
    for (; rays != 0; rays &= rays - 1) ++steps[which[g * lanes + static_cast<std::size_t>(std::countr_zero(rays))]];
  }
};

template <class Node, class D>
void trace(const wide::Tree& tree, const PacketOptions& options, std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  NoCounter counter;
  PacketTraversal<Node, D, NoCounter> traversal(tree, options, query, counter);
  trace_packets(traversal, options.size, rays, hits);
}

template <class Node, class D>
TraceCounts count(const wide::Tree& tree, const PacketOptions& options, std::span<const Ray> rays, Query query,
                  std::span<std::uint32_t> steps) {
  using Counter = RayCounter<lanes_of<D>>;
  std::fill(steps.begin(), steps.end(), 0U);
  Counter counter{{}, steps, {}};
  PacketTraversal<Node, D, Counter> traversal(tree, options, query, counter);
  std::vector<Hit> hits(rays.size());
  trace_packets(traversal, options.size, rays, hits);
  return counter.counts;
}

Functions kernel(const WideBvh& bvh, std::uint32_t size) {
  return bvh.visit([size](const auto& nodes) {
    using Node = std::remove_cvref_t<decltype(nodes[0])>;
    // A packet of four would leave most lanes of a longer vector idle.
    if (size == 4) return Functions{trace<Node, FloatsOf<4>>, count<Node, FloatsOf<4>>};
    return Functions{trace<Node, FloatsOf<16>>, count<Node, FloatsOf<16>>};
  });
}

}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raystudy::packets {

Kernel kernel_for(const WideBvh& bvh, wide::Simd simd, const PacketOptions& options) {
  constexpr std::array<Functions (*)(const WideBvh&, std::uint32_t), 3> kernels RAYSTUDY_OF_EACH(kernel);
  return {kernels[wide::instruction_set(simd)](bvh, options.size), options};
}

}  // namespace raystudy::packets

#endif
