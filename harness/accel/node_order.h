#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"
#include "harness/base/aligned.h"

namespace raystudy {

/// Where the nodes of a tree lie in memory. What is ordered is what a step of a traversal reads: of a Bvh2 pairs of siblings, of
/// a WideBvh nodes. The root comes first in all, and parents before children.
enum class NodeOrder : std::uint8_t {
  preorder,      ///< depth first, the first child's subtree next to its parent
  larger_first,  ///< depth first, the subtree of the child of the largest surface area next to its parent
  by_area,       ///< by descending surface area of the box around the pair or node; equal ones depth first
  van_emde_boas  ///< the upper half of the levels, then the subtrees below it one after another, each of them in the same way:
                 ///< van Emde Boas; Prokop 1999, Sec. 3; of a tree of any shape, halved by its height
};

/// As `layout: …` names them, in the order of NodeOrder.
[[nodiscard]] std::vector<std::string> node_order_names();
[[nodiscard]] NodeOrder node_order(const std::string& name);
/// As `pages: …` names them, in the order of Pages.
[[nodiscard]] std::vector<std::string> pages_names();
[[nodiscard]] Pages pages(const std::string& name);

/// Moves the nodes of a tree into that order, and into such pages. It stays the same tree: siblings keep their sides, and
/// triangles stay where they are.
void arrange(Bvh2& bvh, NodeOrder order, Pages pages);
/// Triangles' corners, too, come into such pages.
void arrange(WideBvh& bvh, NodeOrder order, Pages pages);

}  // namespace raystudy
