#include "harness/method/running_cost.h"

#include <gtest/gtest.h>

#include "tests/support/trees.h"

namespace raystudy {
namespace {

/// Edits that say whether their tree takes the place of the one given.
std::vector<CostSample> traced(const Scene& scene, Bvh2& bvh, bool take) {
  std::vector<CostSample> trace;
  BuildContext context;
  context.cost_trace = &trace;
  edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& /*measure*/, RunningCost::Clock::time_point start) {
    const RunningCost running(tree, context, start);
    running.record(100);
    running.record(120);
    for (PairTree::Leaf& leaf : tree.leaves) leaf.first = (leaf.first + 1) % static_cast<std::uint32_t>(scene.triangles.size());
    return take;
  });
  return trace;
}

TEST(EditAsPairs, TraceEndsWithTheTreeThatComesOut) {
  const Scene scene = test::scene_of(test::random_boxes(20, 1));
  const Bvh2 before = test::random_tree(scene, 1);
  Bvh2 edited = before;
  const std::vector<CostSample> taken = traced(scene, edited, true);
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken.back().cost, 120);
  EXPECT_NE(edited.triangles, before.triangles);

  Bvh2 kept = before;
  const std::vector<CostSample> given_back = traced(scene, kept, false);
  ASSERT_EQ(given_back.size(), 3U);
  EXPECT_EQ(given_back.back().cost, 100);
  EXPECT_GE(given_back.back().seconds, given_back[1].seconds);
  EXPECT_EQ(kept.triangles, before.triangles);
}

}  // namespace
}  // namespace raystudy
