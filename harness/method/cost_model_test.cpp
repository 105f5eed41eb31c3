#include "harness/method/cost_model.h"

#include <gtest/gtest.h>

namespace raystudy {
namespace {

// A root of 2 x 1 x 1 (area 10) over a leaf of 1 x 1 x 1 (area 6, one triangle) and one of 1 x 1 x 0 (area 2, three triangles):
// by Bittner's Eq. 1 with c_T = 3, c_I = 2: (3 * 10 + 2 * (6 * 1 + 2 * 3)) / 10 = 5.4.
Bvh2 two_leaves() {
  Bvh2 bvh;
  bvh.nodes = {{{{0, 0, 0}, {2, 1, 1}}, 2, 0}, {}, {{{0, 0, 0}, {1, 1, 1}}, 0, 1}, {{{1, 0, 0}, {2, 1, 0}}, 1, 3}};
  bvh.triangles = {0, 1, 2, 3};
  return bvh;
}

TEST(TreeCost, IsBittnersEquation1) { EXPECT_DOUBLE_EQ(tree_cost(two_leaves(), {}), 5.4); }

TEST(TreeCost, OfOneLeafIsItsTriangles) {
  Bvh2 bvh;
  bvh.nodes = {{{{0, 0, 0}, {2, 1, 1}}, 0, 4}, {}};
  bvh.triangles = {0, 1, 2, 3};
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 8);
  EXPECT_DOUBLE_EQ(tree_cost(Bvh2{}, {}), 0);
}

TEST(TreeCost, OfAPointSceneCountsEveryNode) {
  Bvh2 bvh = two_leaves();
  for (Bvh2Node& node : bvh.nodes) node.box = {{1, 1, 1}, {1, 1, 1}};
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 3 * 1 + 2 * 4);
}

}  // namespace
}  // namespace raystudy
