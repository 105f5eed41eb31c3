#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/test_name.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

/// What every optimizer owes, whatever it does to the tree.
class EveryOptimizer : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] static std::unique_ptr<Optimizer> make() {
    return Registry::instance().create<Optimizer>(Registry::instance().ref(Role::optimizer, GetParam()));
  }
};

/// Whether the optimizer only moves nodes in memory, so that it neither lowers the cost nor asks for its measure.
bool keeps_the_tree(const std::string& name) { return name == "layout"; }

INSTANTIATE_TEST_SUITE_P(All, EveryOptimizer, testing::ValuesIn(Registry::instance().names(Role::optimizer)), test::test_name);

TEST_P(EveryOptimizer, GivesBackAValidTreeThatCostsNoMore) {
  for (const std::size_t count : {4U, 5U, 10U, 100U, 1000U}) {
    for (const std::uint32_t leaf_triangles : {1U, 4U}) {
      const Scene scene = test::scene_of(test::random_boxes(count, count));
      Bvh2 bvh = test::random_tree(scene, count, leaf_triangles);
      const double before = tree_cost(bvh, {});
      std::vector<CostSample> trace;
      BuildContext context;
      context.cost_trace = &trace;
      make()->optimize(bvh, scene, context);
      EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
      const double after = tree_cost(bvh, {});
      if (keeps_the_tree(GetParam())) {
        EXPECT_NEAR(after, before, 1e-9 * before);
      } else {
        EXPECT_LE(after, before);
        if (count >= 100) {
          EXPECT_LT(after, before);
        }
      }
      ASSERT_FALSE(trace.empty());
      EXPECT_NEAR(trace.front().cost, before, 1e-9 * before);
      EXPECT_NEAR(trace.back().cost, after, 1e-5 * after);
      EXPECT_TRUE(std::is_sorted(trace.begin(), trace.end(), [](auto& a, auto& b) { return a.seconds < b.seconds; }));
    }
  }
}

TEST_P(EveryOptimizer, IsDeterministicForASeed) {
  const Scene scene = test::scene_of(test::random_boxes(500, 1));
  const Bvh2 first = test::random_tree(scene, 1);
  const auto optimized = [&](std::uint64_t seed, int threads) {
    Bvh2 bvh = first;
    BuildContext context;
    context.seed = seed;
    context.threads = threads;
    make()->optimize(bvh, scene, context);
    return bvh;
  };
  const Bvh2 one = optimized(7, 1);
  const Bvh2 two = optimized(7, 2);
  EXPECT_EQ(one.triangles, two.triangles);
  EXPECT_TRUE(std::equal(one.nodes.begin(), one.nodes.end(), two.nodes.begin(), two.nodes.end(),
                         [](auto& a, auto& b) { return a.box == b.box && a.first == b.first && a.count == b.count; }));
}

TEST_P(EveryOptimizer, LeavesDegenerateTreesValid) {
  const float big = 3e38F;
  const float large = 1e20F;  // areas overflow
  const std::vector<std::vector<Box>> cases{
      {},
      {Box{{0, 0, 0}, {1, 1, 1}}},
      test::random_boxes(2, 1),
      test::random_boxes(3, 1),
      std::vector<Box>(50, Box{{0, 0, 0}, {1, 2, 3}}),  // all the same
      std::vector<Box>(50, Box{{1, 1, 1}, {1, 1, 1}}),  // all one point
      {Box{{0, 0, 0}, {1, 0, 0}}, Box{{2, 0, 0}, {3, 0, 0}}, Box{{1, 0, 0}, {9, 0, 0}}, Box{{4, 0, 0}, {5, 0, 0}}},  // on a line
      {Box{{-big, 0, 0}, {big, 0, 0}}, Box{{0, 0, 0}, {1, 1, 1}}, Box{{0, -big, 0}, {0, big, 0}},
       Box{{0, 0, -big}, {big, big, big}}},
      {Box{{-large, 0, 0}, {large, large, 0}}, Box{{0, 0, 0}, {1, 1, 1}}, Box{{5, 5, 5}, {6, 6, 6}}, Box{{5, 0, 0}, {6, 1, 1}}},
      {Box{{0, 0, 0}, {1e-30F, 1e-30F, 0}}, Box{{1e-30F, 0, 0}, {2e-30F, 1e-30F, 0}}, Box{{0, 0, 0}, {1e-38F, 0, 0}}, Box{}}};
  for (std::size_t i = 0; i < cases.size(); ++i) {
    std::vector<Box> boxes = cases[i];
    if (!boxes.empty() && boxes.back().is_empty()) boxes.back() = Box{{0, 0, 0}, {0, 0, 0}};
    const Scene scene = test::scene_of(boxes);
    Bvh2 bvh = test::random_tree(scene, 1);
    make()->optimize(bvh, scene, {});
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty()) << "case " << i;
  }
}

TEST_P(EveryOptimizer, EndsAtOnceWithAValidTreeWhenStopped) {
  const Scene scene = test::scene_of(test::random_boxes(500, 1));
  Bvh2 bvh = test::random_tree(scene, 1);
  const std::atomic<bool> stop{true};
  BuildContext context;
  context.stop = &stop;
  make()->optimize(bvh, scene, context);
  EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
}

/// Surface area by way of the virtual call.
class OtherArea final : public Measure {
 public:
  void evaluate(std::span<const Box> boxes, std::span<float> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = boxes[i].half_area();
  }
};

/// Extent along x: the tree that is best for it is another.
class Width final : public Measure {
 public:
  void evaluate(std::span<const Box> boxes, std::span<float> out) const override {
    for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = boxes[i].is_empty() ? 0 : boxes[i].extent().x;
  }
};

TEST_P(EveryOptimizer, FollowsTheMeasureOfTheCostModel) {
  const Scene scene = test::scene_of(test::random_boxes(300, 2));
  const auto optimized = [&](std::shared_ptr<const Measure> measure) {
    Bvh2 bvh = test::random_tree(scene, 2);
    BuildContext context;
    if (measure) context.cost.measure = std::move(measure);
    make()->optimize(bvh, scene, context);
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
    return bvh;
  };
  const Bvh2 by_area = optimized(nullptr);
  EXPECT_EQ(by_area.triangles, optimized(std::make_shared<OtherArea>()).triangles);
  if (keeps_the_tree(GetParam())) return;
  CostModel width;
  width.measure = std::make_shared<Width>();
  EXPECT_LT(tree_cost(optimized(width.measure), width), tree_cost(by_area, width));
}

}  // namespace
}  // namespace raystudy
