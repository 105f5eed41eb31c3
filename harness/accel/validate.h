#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What is wrong with a tree over `scene`, at most `most` findings, in words; empty for a valid one. Checks the layout Bvh2
/// promises, that no slot is unused, that every inner node's box is exactly the union of its children's, that every triangle is
/// in exactly one leaf, and that a leaf's box contains its triangles'. Where `bvh.duplicates` allows a triangle in several
/// leaves: that it is in each once, that each of their boxes meets its box, and that together they cover the whole triangle
/// (coverage.h).
[[nodiscard]] std::vector<std::string> find_problems(const Bvh2& bvh, const Scene& scene, std::size_t most = 8);

/// The same of a wide tree: that slots in use stand in front and the others hold empty boxes, that every node but the root has
/// one parent, that leaves take up all of `triangles` without overlaps, that the boxes of a node are within that of the slot
/// which refers to it (those of 8 bits need not be; what counts is where all boxes on the way to a leaf overlap), and of
/// triangles what is asked of a Bvh2's; that `corners` are the scene's bit for bit, with their padding, and that `bounds` and
/// `height` are right.
[[nodiscard]] std::vector<std::string> find_problems(const WideBvh& bvh, const Scene& scene, std::size_t most = 8);

/// The same of either; an Accel of another kind has no findings.
[[nodiscard]] std::vector<std::string> find_problems(const Accel& accel, const Scene& scene, std::size_t most = 8);

/// What can be found wrong without the scene, of which only the number of triangles is known: everything but whether boxes hold
/// triangles and corners are theirs. Whatever the tree holds, it can be walked through where nothing is found.
[[nodiscard]] std::vector<std::string> find_structural_problems(const Accel& accel, std::size_t scene_triangles,
                                                                std::size_t most = 8);

}  // namespace raystudy
