#include "methods/rotations/rotations.h"

#include <gmock/gmock.h>

#include <limits>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/trees.h"

namespace raystudy::rotations {
namespace {

const SurfaceArea area;
constexpr double never = std::numeric_limits<double>::infinity();

using test::bar;

/// Children l = ([0, 1], [10, 11]) and r = ([2, 3], [12, 13]), of half area 23 each. The root's record is 1, l's 2, r's 3.
Bvh2 interleaved_bars() {
  Bvh2 bvh;
  bvh.nodes = {
      {bar(0, 13), 2, 0}, {}, {bar(0, 11), 4, 0}, {bar(2, 13), 6, 0}, {bar(0, 1), 0, 1}, {bar(10, 11), 1, 1}, {bar(2, 3), 2, 1},
      {bar(12, 13), 3, 1}};
  bvh.triangles = {0, 1, 2, 3};
  return bvh;
}

TEST(Rotations, ChangeTheAreasOfTheChildren) {
  PairTree tree(interleaved_bars());
  const Rotator rotator(tree, area);
  EXPECT_THAT(rotator.deltas(1), testing::ElementsAre(27 - 23,           // r = (l, rr) = [0, 13]
                                                      23 - 23,           // r = (rl, l) = [0, 11]
                                                      23 - 23,           // l = (r, lr) = [2, 13]
                                                      27 - 23,           // l = (ll, r) = [0, 13]
                                                      19 + 27 - 2 * 23,  // l = (rl, lr) = [2, 11], r = (ll, rr) = [0, 13]
                                                      7 + 7 - 2 * 23));  // l = (rr, lr) = [10, 13], r = (rl, ll) = [0, 3]
  EXPECT_THAT(rotator.deltas(2), testing::Each(never));
}

TEST(Rotations, OfALeafAndAnInnerNode) {
  Bvh2 bvh;  // A = [0, 1] beside r = (B = [2, 3], C = [10, 11]) = [2, 11], of half area 19
  bvh.nodes = {{bar(0, 11), 2, 0}, {}, {bar(0, 1), 0, 1}, {bar(2, 11), 4, 0}, {bar(2, 3), 1, 1}, {bar(10, 11), 2, 1}};
  bvh.triangles = {0, 1, 2};
  PairTree tree(bvh);
  Rotator rotator(tree, area);
  EXPECT_THAT(rotator.deltas(1), testing::ElementsAre(23 - 19, 7 - 19, never, never, never, never));
  EXPECT_DOUBLE_EQ(rotator.inner_sum(), 23 + 19);
  rotator.apply(1, Rotation::l_rr);  // A and B become siblings, C moves up
  EXPECT_DOUBLE_EQ(rotator.inner_sum(), 23 + 7);
  tree.write_to(bvh);
  EXPECT_EQ(bvh.nodes[2].box, bar(10, 11));
  EXPECT_EQ(bvh.nodes[3].box, bar(0, 3));
  EXPECT_THAT(bvh.triangles, testing::UnorderedElementsAre(0, 1, 2));
}

TEST(Rotations, BottomUpOrderHasChildrenFirst) {
  const Scene scene = test::scene_of(test::random_boxes(100, 1));
  const PairTree tree(test::random_tree(scene, 1));
  std::vector<std::uint32_t> order;
  list_bottom_up(tree, order);
  ASSERT_EQ(order.size(), 99U);
  std::vector<bool> seen(tree.pairs.size());
  for (const std::uint32_t n : order) {
    for (const std::uint32_t link : tree.pairs[n].link) EXPECT_TRUE(PairTree::is_leaf(link) || seen[link]);
    seen[n] = true;
  }
  EXPECT_EQ(order.back(), tree.root());
}

// Every rotation of every node of random trees: what it was said to change is what Eq. 1 changes by.
TEST(Rotations, DeltasAreTheChangesOfTheTreesCost) {
  const CostModel model;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(40, seed));
    const Bvh2 first = test::random_tree(scene, seed);
    const double unit = 3 / static_cast<double>(first.nodes[0].box.half_area());
    for (std::uint32_t n = 1; n < first.leaf_count(); ++n) {
      for (std::size_t i = 0; i < rotation_count; ++i) {
        PairTree tree(first);
        Rotator rotator(tree, area);
        const double delta = rotator.deltas(n)[i];
        if (delta == never) continue;
        rotator.apply(n, static_cast<Rotation>(i));
        Bvh2 rotated = first;
        tree.write_to(rotated);
        ASSERT_THAT(find_problems(rotated, scene), testing::IsEmpty());
        ASSERT_NEAR(tree_cost(rotated, model) - tree_cost(first, model), unit * delta, 1e-9);
      }
    }
  }
}

TEST(HillClimbing, EndsWhereNoRotationLowersTheCost) {
  const Scene scene = test::scene_of(test::random_boxes(300, 1));
  Bvh2 bvh = test::random_tree(scene, 1);
  std::vector<CostSample> trace;
  BuildContext context;
  context.cost_trace = &trace;
  Registry::instance()
      .create<Optimizer>(Registry::instance().ref(Role::optimizer, "rotation-hill-climbing"))
      ->optimize(bvh, scene, context);
  for (std::size_t i = 1; i < trace.size(); ++i) EXPECT_LE(trace[i].cost, trace[i - 1].cost * (1 + 1e-12));
  EXPECT_NEAR(trace.back().cost, tree_cost(bvh, {}), 1e-9 * trace.back().cost);
  PairTree tree(bvh);
  const Rotator rotator(tree, area);
  for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) EXPECT_THAT(rotator.deltas(n), testing::Each(testing::Ge(0)));
}

double annealed_cost(const Scene& scene, std::map<std::string, ParamValue, std::less<>> changes, std::uint64_t seed) {
  Bvh2 bvh = test::random_tree(scene, 1);
  BuildContext context;
  context.seed = seed;
  Registry::instance()
      .create<Optimizer>(Registry::instance().ref(Role::optimizer, "rotation-annealing", std::move(changes)))
      ->optimize(bvh, scene, context);
  return tree_cost(bvh, {});
}

TEST(Annealing, GoesBelowHillClimbing) {
  const Scene scene = test::scene_of(test::random_boxes(300, 1));
  const double climbed = annealed_cost(scene, {{"passes", std::int64_t{0}}}, 1);
  EXPECT_LT(annealed_cost(scene, {}, 1), 0.97 * climbed);
  EXPECT_NE(annealed_cost(scene, {}, 1), annealed_cost(scene, {}, 2));
}

TEST(Annealing, KeepsTheCheapestTreeOfAHotRun) {
  const Scene scene = test::scene_of(test::random_boxes(300, 1));
  const double before = tree_cost(test::random_tree(scene, 1), {});
  EXPECT_LT(annealed_cost(scene, {{"passes", std::int64_t{5}}, {"first_temperature", 1e6}, {"last_temperature", 1e6}}, 1),
            before);
}

}  // namespace
}  // namespace raystudy::rotations
