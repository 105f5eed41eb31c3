#include "methods/insertion/selection.h"

#include <gmock/gmock.h>

#include "harness/method/pair_measure.h"
#include "methods/insertion/passes.h"
#include "tests/support/trees.h"

namespace raystudy::insertion {
namespace {

TEST(BatchSize, IsAShareOfAllNodes) {
  EXPECT_EQ(batch_size(1, 999, 1000), 20U);  // 1 % of 1999, rounded up
  EXPECT_EQ(batch_size(1, 2, 3), 1U);
  EXPECT_EQ(batch_size(100, 999, 1000), 999U);
  EXPECT_EQ(batch_size(0.0001, 999, 1000), 1U);
}

TEST(Selector, TakesTheLargestInDescendingOrder) {
  const Scene scene = test::scene_of(test::random_boxes(100, 1));
  PairTree tree(test::random_tree(scene, 1));
  measure_all(tree, SurfaceArea{});
  const auto measure_of = [&](std::uint32_t n) { return tree.pairs[tree.up[n] / 2].measure[tree.up[n] % 2]; };
  Selector selector(1);
  const std::vector<std::uint32_t> all = selector.by_area(tree, 99);
  EXPECT_EQ(all.front(), tree.root());
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_GE(measure_of(all[i - 1]), measure_of(all[i]));
  const std::vector<std::uint32_t> some = selector.by_area(tree, 10);
  EXPECT_THAT(some, testing::ElementsAreArray(all.begin(), all.begin() + 10));
  // After a pass that knew a higher floor, more are found than lie above it.
  EXPECT_THAT(selector.by_area(tree, 99), testing::ElementsAreArray(all));
}

TEST(Selector, AtRandomReachesEveryInnerNodeAndNothingElse) {
  const Scene scene = test::scene_of(test::random_boxes(20, 1));
  const PairTree tree(test::random_tree(scene, 1));
  Selector selector(1);
  std::vector<int> times(20);
  for (const std::uint32_t n : selector.at_random(tree, 1900)) ++times.at(n);
  EXPECT_EQ(times[0], 0);  // no inner node has record 0
  for (std::size_t n = 1; n < 20; ++n) EXPECT_NEAR(times[n], 100, 50) << n;
}

/// The chain itself is in proportion to the measures. What is selected are its moves to another node: of x, its share of the
/// chain times the chance to be accepted away from it.
TEST(Selector, ByMetropolisHastingsSelectsTheMovesOfAChainInProportionToTheMeasure) {
  const Scene scene = test::scene_of(test::random_boxes(40, 1));
  PairTree tree(test::random_tree(scene, 1));
  measure_all(tree, SurfaceArea());
  std::vector<double> measures(40);
  for (std::uint32_t n = 1; n < 40; ++n) {
    const std::uint32_t slot = tree.up[n];
    if (n != tree.root()) measures[n] = static_cast<double>(tree.pairs[slot / 2].measure[slot % 2]);
  }
  std::vector<double> expected(40);
  double sum = 0;
  for (std::size_t x = 1; x < 40; ++x) {
    for (std::size_t y = 1; y < 40; ++y) expected[x] += x == y ? 0 : std::min(measures[x], measures[y]);
    sum += expected[x];
  }
  Selector selector(1);
  std::vector<double> times(40);
  std::uint32_t before = 0;
  for (const std::uint32_t n : selector.by_metropolis_hastings(tree, 200'000)) {
    ++times.at(n);
    EXPECT_NE(n, before);
    before = n;
  }
  EXPECT_EQ(times[tree.root()], 0);
  for (std::size_t n = 1; n < 40; ++n) EXPECT_NEAR(times[n] / 200'000, expected[n] / sum, 0.001) << n;
}

TEST(Progress, SwitchesToRandomThenStops) {
  Options options;
  options.random_passes = 2;
  options.stop_passes = 3;
  Progress progress(options, 10);
  EXPECT_TRUE(progress.add_pass(9));
  EXPECT_FALSE(progress.add_pass(9));    // no reduction: first
  EXPECT_TRUE(progress.add_pass(8));     // a new least cost: counting starts again
  EXPECT_FALSE(progress.add_pass(8.5));  // lower than nothing before
  EXPECT_FALSE(progress.selects_at_random());
  EXPECT_FALSE(progress.add_pass(8.2));  // lower than the last pass, but not the least: second
  EXPECT_TRUE(progress.selects_at_random());
  EXPECT_FALSE(progress.add_pass(8.2));
  EXPECT_FALSE(progress.add_pass(8.2));
  EXPECT_FALSE(progress.is_done());
  EXPECT_TRUE(progress.add_pass(7));
  EXPECT_TRUE(progress.selects_at_random());  // there is no way back
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(progress.is_done());
    EXPECT_FALSE(progress.add_pass(7));
  }
  EXPECT_TRUE(progress.is_done());
}

TEST(Progress, OfAreaNeverSelectsAtRandomAndOfRandomAlways) {
  Options options;
  options.selection = Selection::area;
  Progress area(options, 10);
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(area.is_done());
    EXPECT_FALSE(area.selects_at_random());
    area.add_pass(10);
  }
  EXPECT_TRUE(area.is_done());
  options.selection = Selection::random;
  EXPECT_TRUE(Progress(options, 10).selects_at_random());
}

TEST(Progress, EndsAfterTheMostPasses) {
  Options options;
  options.max_passes = 2;
  Progress progress(options, 10);
  progress.add_pass(9);
  EXPECT_FALSE(progress.is_done());
  progress.add_pass(8);
  EXPECT_TRUE(progress.is_done());
}

}  // namespace
}  // namespace raystudy::insertion
