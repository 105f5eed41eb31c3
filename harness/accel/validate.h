#pragma once

#include <string>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What is wrong with a tree over `scene`, at most `most` findings, in words; empty for a valid one. Checks the layout Bvh2
/// promises, that every triangle is in exactly one leaf (or, with `duplicates`, in at least one), that each box contains its
/// children's and a leaf's box its triangles' (not with `duplicates`, where a leaf may hold a clipped part), that no slot is
/// unused, and that every inner node's box is exactly the union of its children's.
[[nodiscard]] std::vector<std::string> find_problems(const Bvh2& bvh, const Scene& scene, bool duplicates = false,
                                                     std::size_t most = 8);

}  // namespace raystudy
