#include "harness/method/cost_model.h"

#include <gtest/gtest.h>

#include "harness/method/tree_figures.h"
#include "tests/support/wide_trees.h"

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

// Of extents 11, 5, 3, 1, 3 and 1 along x, and 1 along y and z, the areas are 23, 11, 7, 3, 7 and 3:
// (3 * (23 + 11) + 2 * (7 * 2 + 3 + 7 * 2 + 3)) / 23.
TEST(TreeCost, OfAWideTree) {
  EXPECT_DOUBLE_EQ(tree_cost(test::HandMade<WideNode<4>>().bvh, {}), 170.0 / 23);
  EXPECT_DOUBLE_EQ(tree_cost(test::HandMade<QuantizedNode<16>>().bvh, {}), 170.0 / 23);
  EXPECT_DOUBLE_EQ(tree_cost(WideBvh{}, {}), 0);
}

TEST(TreeFigures, OfBothForms) {
  const TreeFigures binary = tree_figures(two_leaves(), {});
  EXPECT_EQ(binary.inner_nodes, 1U);
  EXPECT_EQ(binary.leaves, 2U);
  EXPECT_EQ(binary.references, 4U);
  EXPECT_EQ(binary.depth, 1U);
  EXPECT_DOUBLE_EQ(binary.cost, 5.4);
  const TreeFigures wide = tree_figures(test::HandMade<WideNode<8>>().bvh, {});
  EXPECT_EQ(wide.inner_nodes, 2U);
  EXPECT_EQ(wide.leaves, 4U);
  EXPECT_EQ(wide.references, 6U);
  EXPECT_EQ(wide.depth, 2U);
  EXPECT_DOUBLE_EQ(wide.cost, 170.0 / 23);
}

}  // namespace
}  // namespace raystudy
