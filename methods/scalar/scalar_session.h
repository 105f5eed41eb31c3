#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/base/aligned.h"
#include "harness/geometry/slab.h"
#include "harness/geometry/watertight.h"
#include "harness/method/method.h"

namespace raystudy::scalar {

/// Two siblings in one cache line, in the place of their pair in Bvh2::nodes: the same tree in the same memory order and size,
/// with the boxes transposed for `test_boxes`. `first` of an inner child is the index of its own children's pair.
struct alignas(64) NodePair {
  SlabPair boxes;
  std::array<std::uint32_t, 2> first;
  std::array<std::uint32_t, 2> count;
};
static_assert(sizeof(NodePair) == 64);

/// Ordered single-ray traversal of a binary BVH: both children are tested in one step, the nearer is visited first, and what
/// waits on the stack is dropped once a nearer hit is known.
///
/// A closest hit is the one with the least t, of several with equal t the one of the lowest triangle index. As slab tests are
/// conservative (slab.h), hits do not depend on the tree: they equal those of testing every triangle, bit for bit.
class ScalarSession final : public TraceSession {
 public:
  ScalarSession(const Bvh2& bvh, const Scene& scene, int threads);

  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override;
  [[nodiscard]] bool counts() const override { return true; }
  TraceCounts count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) override;

 private:
  struct Pending {
    std::uint32_t first;
    std::uint32_t count;
    float near;
  };

  template <bool any, class Counter>
  Hit trace_one(const Ray& ray, Pending* stack, Counter& counter) const;
  template <class Counter, class Write>
  Counter trace_tile(std::span<const Ray> rays, Query query, Write&& write) const;

  std::vector<NodePair, AlignedAllocator<NodePair>> pairs_;
  std::vector<PackedTriangle> packed_;  ///< in the order of `triangles_`, so that a leaf reads forward
  const std::vector<std::uint32_t>& triangles_;
  Box bounds_;
  std::uint32_t root_first_ = 0;
  std::uint32_t root_count_ = 0;
  bool empty_;
  std::size_t stack_size_ = 1;  ///< one entry a level: no tree is too deep
  int threads_;
};

}  // namespace raystudy::scalar
