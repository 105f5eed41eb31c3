#pragma once

#include <string>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What is wrong with a tree over `scene`, at most `most` findings, in words; empty for a valid one. Checks the layout Bvh2
/// promises, that no slot is unused, that every inner node's box is exactly the union of its children's, that every triangle is
/// in exactly one leaf, and that a leaf's box contains its triangles'. Where `bvh.duplicates` allows a triangle in several
/// leaves: that it is in each once, that each of their boxes meets its box, and that together they cover the whole triangle
/// (coverage.h).
[[nodiscard]] std::vector<std::string> find_problems(const Bvh2& bvh, const Scene& scene, std::size_t most = 8);

}  // namespace raystudy
