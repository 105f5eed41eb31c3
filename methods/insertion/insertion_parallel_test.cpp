#include <gmock/gmock.h>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "methods/insertion/conflicts.h"
#include "tests/support/trees.h"

namespace raystudy::insertion {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

std::unique_ptr<Optimizer> make(const Changes& changes = {}) {
  return Registry::instance().create<Optimizer>(Registry::instance().ref(Role::optimizer, "insertion-parallel", changes));
}

/// The paper's way: all of every µ-th node searched in the same tree, single nodes only.
Changes paper() {
  return {{"candidates", std::string("modulo")},
          {"remove", std::string("nodes")},
          {"search", std::string("all")},
          {"batch", std::int64_t{1'000'000'000}}};
}

using test::bar;

/// root (P, Q), P (X, B), Q (Y, D), X (A0, A1), Y (C0, C1): records 1 to 5; X stands at slot 4, Y at 8.
PairTree two_by_two() {
  Bvh2 bvh;
  const auto leaf = [](float at, std::uint32_t first) { return Bvh2Node{bar(at, at + 1), first, 1}; };
  bvh.nodes = {{bar(0, 23), 2, 0}, {},         {bar(0, 7), 4, 0},    {bar(16, 23), 8, 0}, {bar(0, 3), 6, 0}, leaf(6, 2),
               leaf(0, 0),         leaf(2, 1), {bar(16, 19), 10, 0}, leaf(22, 5),         leaf(16, 3),       leaf(18, 4)};
  bvh.triangles = {0, 1, 2, 3, 4, 5};
  return PairTree(bvh);
}

TEST(Conflicts, ExcludeWhatTouchesTheSameNodes) {
  const PairTree tree = two_by_two();
  const std::uint32_t x = 4;
  ASSERT_EQ(tree.up[3], x);
  const std::uint32_t q = 3;
  const std::uint32_t y = tree.up[5];
  Conflicts conflicts(tree, false);
  conflicts.begin_batch();
  EXPECT_TRUE(conflicts.take_node(x, q));
  EXPECT_FALSE(conflicts.take_node(5, 2 * 5)) << "the sibling of X";
  EXPECT_FALSE(conflicts.take_node(6, q)) << "the same place";
  EXPECT_FALSE(conflicts.take_node(y, 7)) << "takes out Q, whose place is taken";
  conflicts.begin_batch();
  EXPECT_TRUE(conflicts.take_node(y, 7));
}

TEST(Conflicts, NeverMoveANodeBelowItself) {
  const PairTree tree = two_by_two();
  Conflicts conflicts(tree, false);
  conflicts.begin_batch();
  EXPECT_FALSE(conflicts.take_node(2, 6));
  EXPECT_FALSE(conflicts.take_children(3, {3, 6}));
  EXPECT_TRUE(conflicts.take_node(4, 3)) << "what was refused took nothing";
}

TEST(Conflicts, OfWholePaths) {
  const PairTree tree = two_by_two();
  const std::uint32_t d = tree.up[5] ^ 1U;
  Conflicts nodes(tree, false);
  nodes.begin_batch();
  EXPECT_TRUE(nodes.take_node(6, d));   // A0 to D: P shrinks
  EXPECT_TRUE(nodes.take_node(10, 2));  // C0 to P
  Conflicts paths(tree, true);
  paths.begin_batch();
  EXPECT_TRUE(paths.take_node(6, d));
  EXPECT_FALSE(paths.take_node(10, 2));
}

TEST(InsertionParallel, EveryWayGivesAValidCheaperTree) {
  const Scene scene = test::scene_of(test::random_boxes(2000, 1));
  const Bvh2 first = test::random_tree(scene, 1);
  const double before = tree_cost(first, {});
  std::vector<Changes> ways{{}, paper(), {{"batch", std::int64_t{1}}}, {{"last_percent", 100.0}}, {{"loss", 10.0}}};
  ways.push_back({{"candidates", std::string("area")}, {"last_percent", 100.0}});
  ways.push_back({{"candidates", std::string("modulo")}});
  ways.push_back({{"conflicts", std::string("paths")}});
  ways.push_back({{"remove", std::string("nodes")}});
  ways.push_back({{"search", std::string("all")}});
  for (std::size_t i = 0; i < ways.size(); ++i) {
    Bvh2 bvh = first;
    make(ways[i])->optimize(bvh, scene, {});
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty()) << "way " << i;
    EXPECT_LT(tree_cost(bvh, {}), 0.8 * before) << "way " << i;
  }
}

TEST(InsertionParallel, IsTheSameWhateverTheThreads) {
  const Scene scene = test::scene_of(test::random_boxes(1500, 2));
  const Bvh2 first = test::random_tree(scene, 2);
  for (const Changes& changes : {Changes{}, paper()}) {
    std::vector<Bvh2> results;
    for (const int threads : {1, 2, 4}) {
      Bvh2 bvh = first;
      BuildContext context;
      context.threads = threads;
      make(changes)->optimize(bvh, scene, context);
      results.push_back(bvh);
    }
    for (const Bvh2& other : results) {
      EXPECT_EQ(other.triangles, results[0].triangles);
      EXPECT_EQ(tree_cost(other, {}), tree_cost(results[0], {}));
    }
  }
}

TEST(InsertionParallel, EndsWhereNoNodeGainsAnything) {
  const Scene scene = test::scene_of(test::random_boxes(300, 3));
  Bvh2 bvh = test::random_tree(scene, 3);
  Changes changes{{"remove", std::string("nodes")},
                  {"last_percent", 100.0},
                  {"search", std::string("all")},
                  {"batch", std::int64_t{1}},
                  {"tolerance_percent", 0.0}};
  make(changes)->optimize(bvh, scene, {});
  const double once = tree_cost(bvh, {});
  make(changes)->optimize(bvh, scene, {});
  EXPECT_NEAR(tree_cost(bvh, {}), once, 1e-4 * once);
}

TEST(InsertionParallel, StopsAfterTheGivenPasses) {
  const Scene scene = test::scene_of(test::random_boxes(500, 4));
  const Bvh2 first = test::random_tree(scene, 4);
  double cost = tree_cost(first, {});
  for (const std::int64_t passes : {1, 2, 3}) {
    Bvh2 bvh = first;
    std::vector<CostSample> trace;
    BuildContext context;
    context.cost_trace = &trace;
    make({{"max_passes", passes}, {"batch", std::int64_t{1'000'000}}})->optimize(bvh, scene, context);
    EXPECT_EQ(trace.size(), static_cast<std::size_t>(1 + passes));  // a pass is one batch
    EXPECT_NEAR(trace.back().cost, tree_cost(bvh, {}), 1e-6 * cost);
    EXPECT_LT(tree_cost(bvh, {}), cost);
    cost = tree_cost(bvh, {});
  }
}

}  // namespace
}  // namespace raystudy::insertion
