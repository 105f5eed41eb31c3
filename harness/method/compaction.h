#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/method/cost_model.h"

namespace raystudy {

/// Collapses every subtree whose cost is larger than that of one leaf over its triangles (Bittner 2015, Section 2.6): in
/// post-order, so that a subtree is compared after its own subtrees are as cheap as they get, which gives the cheapest tree that
/// collapsing can reach. Equal costs do not collapse. Leaves of more than `max_leaf_triangles` are not made; 0: no limit. Nodes
/// and triangles come out depth first. A triangle of several leaves that become one (Bvh2::duplicates) counts and stays once. A
/// root of measure 0 counts every box as tree_cost does.
void compact(Bvh2& bvh, const CostModel& model, std::uint32_t max_leaf_triangles = 0);

/// The same with a measure of its own for every node of `bvh` in place of the model's, such as one over several frames.
void compact(Bvh2& bvh, std::vector<float> measures, const CostModel& model, std::uint32_t max_leaf_triangles);

/// tree_cost of the tree that `compact` would make, without making it; 0 for an empty tree.
[[nodiscard]] double compacted_cost(const Bvh2& bvh, const CostModel& model, std::uint32_t max_leaf_triangles = 0);

}  // namespace raystudy
