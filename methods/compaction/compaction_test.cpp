#include "harness/method/compaction.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

/// A root over [0, 2] x 1 x 1 (half area 5) with two unit cubes (3 each), of one triangle each.
Bvh2 two_cubes() {
  Bvh2 bvh;
  bvh.nodes = {{{{0, 0, 0}, {2, 1, 1}}, 2, 0}, {}, {{{0, 0, 0}, {1, 1, 1}}, 0, 1}, {{{1, 0, 0}, {2, 1, 1}}, 1, 1}};
  bvh.triangles = {7, 8};
  return bvh;
}

CostModel costs(float traversal, float intersection) {
  CostModel model;
  model.traversal = traversal;
  model.intersection = intersection;
  return model;
}

TEST(Compaction, CollapsesWhereASubtreeCostsMoreThanALeaf) {
  // As a tree 3 * 5 + 2 * (3 + 3) = 27, as a leaf 2 * 5 * 2 = 20; over the root's 5: 5.4 and 4.
  Bvh2 bvh = two_cubes();
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 5.4);
  EXPECT_DOUBLE_EQ(compacted_cost(bvh, {}), 4);
  compact(bvh, {});
  ASSERT_EQ(bvh.nodes.size(), 2U);
  EXPECT_EQ(bvh.nodes[0].count, 2U);
  EXPECT_EQ(bvh.nodes[0].box, Box({0, 0, 0}, {2, 1, 1}));
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(7, 8));
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 4);
}

TEST(Compaction, LeavesATreeThatCostsNoMoreThanALeaf) {
  // c_T = 4, c_I = 5: 4 * 5 + 5 * 6 = 50 as a tree, 5 * 5 * 2 = 50 as a leaf. Equal costs stay.
  Bvh2 bvh = two_cubes();
  EXPECT_DOUBLE_EQ(compacted_cost(bvh, costs(4, 5)), 10);
  compact(bvh, costs(4, 5));
  EXPECT_EQ(bvh.nodes.size(), 4U);
  compact(bvh, costs(4.01F, 5));
  EXPECT_EQ(bvh.nodes.size(), 2U);
}

TEST(Compaction, MakesNoLeafAboveTheLimit) {
  Bvh2 bvh = two_cubes();
  EXPECT_DOUBLE_EQ(compacted_cost(bvh, {}, 1), 5.4);
  compact(bvh, {}, 1);
  EXPECT_EQ(bvh.nodes.size(), 4U);
}

TEST(Compaction, CountsATriangleOfSeveralLeavesOnce) {
  // One triangle in both halves: as a tree 27, as a leaf 2 * 5 * 1 = 10.
  Bvh2 bvh = two_cubes();
  bvh.triangles = {7, 7};
  bvh.duplicates = true;
  EXPECT_DOUBLE_EQ(compacted_cost(bvh, {}), 2);
  // One triangle is no more than a leaf of one may hold.
  compact(bvh, {}, 1);
  ASSERT_EQ(bvh.nodes.size(), 2U);
  EXPECT_EQ(bvh.nodes[0].count, 1U);
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(7));
  EXPECT_TRUE(bvh.duplicates);
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 2);
}

TEST(Compaction, OfTrivialTrees) {
  Bvh2 empty;
  compact(empty, {});
  EXPECT_TRUE(empty.empty());
  EXPECT_EQ(compacted_cost(empty, {}), 0);
  Bvh2 leaf;
  leaf.nodes = {{{{0, 0, 0}, {2, 1, 1}}, 0, 3}, {}};
  leaf.triangles = {2, 0, 1};
  EXPECT_DOUBLE_EQ(compacted_cost(leaf, {}), 6);
  compact(leaf, {});
  EXPECT_THAT(leaf.triangles, testing::ElementsAre(2, 0, 1));
}

TEST(Compaction, OfAPointSceneIsOneLeaf) {
  const Scene scene = test::scene_of(std::vector<Box>(9, Box{{1, 1, 1}, {1, 1, 1}}));
  Bvh2 bvh = test::random_tree(scene, 1);
  EXPECT_DOUBLE_EQ(compacted_cost(bvh, {}), 2 * 9);
  compact(bvh, {});
  EXPECT_EQ(bvh.leaf_count(), 1U);
  EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
}

/// The least cost, times m(root), over every way to collapse subtrees: each inner node of each tree is collapsed or not.
double least_cost(const Bvh2& bvh, const CostModel& model, std::uint32_t limit, std::uint32_t i) {
  const Bvh2Node& node = bvh.nodes[i];
  const auto m = static_cast<double>(node.box.half_area());
  std::uint32_t triangles = 0;
  std::vector<std::uint32_t> stack{i};
  while (!stack.empty()) {
    const Bvh2Node& below = bvh.nodes[stack.back()];
    stack.pop_back();
    triangles += below.count;
    if (!below.is_leaf()) stack.insert(stack.end(), {below.first, below.first + 1});
  }
  const double leaf = static_cast<double>(model.intersection) * m * triangles;
  if (node.is_leaf()) return leaf;
  const double subtree = static_cast<double>(model.traversal) * m + least_cost(bvh, model, limit, node.first) +
                         least_cost(bvh, model, limit, node.first + 1);
  return limit == 0 || triangles <= limit ? std::min(leaf, subtree) : subtree;
}

TEST(Compaction, GivesTheCheapestTree) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(1 + 5 * seed, seed));
    for (const CostModel& model : {costs(3, 2), costs(1, 1), costs(0.1F, 1), costs(10, 1)}) {
      for (const std::uint32_t limit : {0U, 3U, 8U}) {
        Bvh2 bvh = test::random_tree(scene, seed, 2);
        const double expected = least_cost(bvh, model, limit, 0) / static_cast<double>(bvh.nodes[0].box.half_area());
        const double before = tree_cost(bvh, model);
        EXPECT_NEAR(compacted_cost(bvh, model, limit), expected, 1e-12 * expected);
        compact(bvh, model, limit);
        EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
        EXPECT_NEAR(tree_cost(bvh, model), expected, 1e-12 * expected);
        EXPECT_LE(tree_cost(bvh, model), before * (1 + 1e-12));
        if (limit >= 2) {
          for (const Bvh2Node& node : bvh.nodes) EXPECT_LE(node.count, limit);
        }
      }
    }
  }
}

TEST(Compaction, IsAnOptimizer) {
  Bvh2 bvh = two_cubes();
  const auto ref = Registry::instance().ref(Role::optimizer, "compaction", {{"max_leaf_triangles", std::int64_t{1}}});
  Registry::instance().create<Optimizer>(ref)->optimize(bvh, {}, {});
  EXPECT_EQ(bvh.nodes.size(), 4U);
  Registry::instance().create<Optimizer>(Registry::instance().ref(Role::optimizer, "compaction"))->optimize(bvh, {}, {});
  EXPECT_EQ(bvh.nodes.size(), 2U);
}

}  // namespace
}  // namespace raystudy
