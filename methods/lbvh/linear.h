#pragma once

#include <cstdint>

#include "harness/accel/bvh2.h"
#include "harness/method/cost_model.h"
#include "methods/lbvh/order.h"

// Whole trees, in an empty `bvh`, over a scene that has triangles. Both work in the calling thread's arena; `threads` 1 keeps to
// the calling thread.

namespace raystudy::lbvh {

enum class Construction : std::uint8_t {
  apetrei,  ///< bottom-up, nodes and boxes in one pass (hierarchy.h)
  karras    ///< every inner node by itself, then boxes (karras.h)
};

/// A tree whose splits the keys alone decide (README.md, 1 to 5 and 8). `shape` has no treelets.
void build_linear(const Scene& scene, const Shape& shape, Construction construction, int threads, Bvh2& bvh);

/// A tree of treelets under splits between `bins` bins by `measure` (README.md, 1 to 8).
void build_treelets(const Scene& scene, const Shape& shape, const Measure& measure, std::uint32_t bins, int threads, Bvh2& bvh);

}  // namespace raystudy::lbvh
