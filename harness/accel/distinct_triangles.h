#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"

namespace raystudy {

/// How many different triangles are in the leaves under each node, by index into `bvh.nodes`; for nodes[1] it is 0. Where the
/// tree has no duplicates, the sum of its leaves' counts.
[[nodiscard]] std::vector<std::uint32_t> distinct_triangles(const Bvh2& bvh);

/// One more than the highest index in `bvh.triangles`; 0 for an empty tree.
[[nodiscard]] std::uint32_t triangle_limit(const Bvh2& bvh);

}  // namespace raystudy
