#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "harness/accel/refit.h"
#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "harness/spec/plan.h"
#include "methods/tsah/frame_optimization.h"
#include "tests/support/animated.h"
#include "tests/support/files.h"
#include "tests/support/same_tree.h"

namespace raystudy::tsah {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;
using insertion::FrameBoxes;

Bvh2 optimized(const std::string& name, const Scene& scene, Changes changes, std::uint64_t seed = 1) {
  const Registry& registry = Registry::instance();
  Bvh2 bvh = test::random_tree(scene, 3);
  BuildContext context;
  context.seed = seed;
  registry.create<Optimizer>(registry.ref(Role::optimizer, name, std::move(changes)))->optimize(bvh, scene, context);
  return bvh;
}

std::vector<double> costs_in(const Bvh2& bvh, const Scene& scene, std::size_t frames) {
  std::vector<double> costs;
  Bvh2 copy = bvh;
  for (AlignedVector<Bvh2Node>& nodes : nodes_in_frames(bvh, scene, resampled_frames(scene, frames))) {
    copy.nodes = std::move(nodes);
    costs.push_back(tree_cost(copy, {}));
  }
  return costs;
}

TEST(Tsah, WithOneFrameIsInsertionBitForBit) {
  for (const std::size_t count : {3U, 50U, 1000U}) {
    const Scene scene = test::crossing_boxes(count, 6, count);
    for (const auto& [ours, theirs] :
         {std::pair{"metropolis-hastings", "metropolis-hastings"}, {"batch-sort", "area-then-random"}, {"random", "random"}}) {
      for (const double exponent : {0.0, 2.0}) {
        for (const std::uint64_t seed : {1U, 9U}) {
          const Bvh2 one = optimized("tsah", scene,
                                     {{"frames", std::int64_t{1}},
                                      {"exponent", exponent},
                                      {"selection", std::string(ours)},
                                      {"stop_batches", std::int64_t{4}},
                                      {"random_batches", std::int64_t{2}}},
                                     seed);
          const Bvh2 other = optimized(
              "insertion", scene,
              {{"batch_percent", 2.0}, {"selection", std::string(theirs)}, {"p_T", std::int64_t{4}}, {"p_R", std::int64_t{2}}},
              seed);
          EXPECT_TRUE(test::same(one, other)) << count << " triangles, " << ours;
        }
      }
    }
  }
}

/// The code for several frames with one, through the same search: the same tree again.
TEST(Tsah, RecordsOfSeveralFramesSearchAsThoseOfOne) {
  const Scene scene = test::crossing_boxes(800, 3, 4);
  const std::vector<SharedArray<Vec3>> first = resampled_frames(scene, 1);
  const insertion::Options options{.batch_percent = 2, .stop_passes = 3, .selection = insertion::Selection::metropolis_hastings};
  const Bvh2 expected = optimized("tsah", scene, {{"frames", std::int64_t{1}}});
  const auto expect_same = [&]<class Boxes>(Boxes /*type*/) {
    Bvh2 bvh = test::random_tree(scene, 3);
    optimize_over_frames<Boxes>(bvh, scene, first, 0, options, {});
    EXPECT_TRUE(test::same(bvh, expected)) << Boxes::frames;
  };
  expect_same(FrameBoxes<2, 1>());
  expect_same(FrameBoxes<5, 1>());
  expect_same(FrameBoxes<8, 2>());
}

TEST(Tsah, LowersTheMeanCostOfAllFrames) {
  const Scene scene = test::crossing_boxes(2000, 6, 1);
  for (const std::size_t frames : {2U, 3U, 4U, 5U, 7U, 10U, 16U, 20U, 40U}) {
    const Bvh2 bvh = optimized("tsah", scene, {{"frames", static_cast<std::int64_t>(frames)}});
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
    const double mean = animation_cost(costs_in(bvh, scene, 21), 0);
    const double first_only = animation_cost(costs_in(optimized("tsah", scene, {{"frames", std::int64_t{1}}}), scene, 21), 0);
    EXPECT_LT(mean, 0.8 * first_only) << frames << " frames";
  }
}

/// Triangles that stand in rows, and in the last frame anywhere: a peak of the cost that a higher exponent lowers.
TEST(Tsah, HigherExponentsLowerTheGreatestCost) {
  Scene scene = test::crossing_boxes(3000, 2, 8);
  std::vector<Vec3> still(scene.frames[0].begin(), scene.frames[0].end());
  scene.frames = {SharedArray(still), SharedArray(still), SharedArray(still), SharedArray(still), scene.frames[1]};
  const auto greatest = [&](double exponent) {
    const std::vector<double> costs = costs_in(optimized("tsah", scene, {{"exponent", exponent}}), scene, 5);
    return *std::max_element(costs.begin(), costs.end());
  };
  EXPECT_LT(greatest(4), greatest(0));
}

TEST(Tsah, TheTraceIsOfTheAnimationsCost) {
  const Scene scene = test::crossing_boxes(500, 5, 2);
  for (const double exponent : {0.0, 3.0}) {
    const Registry& registry = Registry::instance();
    Bvh2 bvh = test::random_tree(scene, 3);
    const double before = animation_cost(costs_in(bvh, scene, 5), exponent);
    std::vector<CostSample> trace;
    BuildContext context;
    context.cost_trace = &trace;
    registry.create<Optimizer>(registry.ref(Role::optimizer, "tsah", {{"exponent", exponent}}))->optimize(bvh, scene, context);
    EXPECT_NEAR(trace.front().cost, before, 1e-5 * before);
    const double after = animation_cost(costs_in(bvh, scene, 5), exponent);
    EXPECT_NEAR(trace.back().cost, after, 1e-5 * after) << "exponent " << exponent;
  }
}

TEST(Tsah, CompactionOverFramesLowersTheirCostTogether) {
  const Scene scene = test::crossing_boxes(1000, 5, 3);
  const Registry& registry = Registry::instance();
  const Bvh2 tree = optimized("tsah", scene, {});
  const auto compacted = [&](std::int64_t frames) {
    Bvh2 bvh = tree;
    registry.create<Optimizer>(registry.ref(Role::optimizer, "compaction", {{"frames", frames}}))->optimize(bvh, scene, {});
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
    return animation_cost(costs_in(bvh, scene, 5), 0);
  };
  EXPECT_LT(compacted(5), animation_cost(costs_in(tree, scene, 5), 0));
  EXPECT_LT(compacted(5), compacted(0)) << "what is best for the first frame is not for all";
}

TEST(FrameWeights, ArePowersOfCostsOverTheRootsMeasures) {
  const std::vector<double> costs{10, 20};
  const std::vector<double> roots{4, 2};
  EXPECT_THAT(frame_weights(costs, roots, 0), testing::ElementsAre(0.5F, 1.0F));
  EXPECT_THAT(frame_weights(costs, roots, 2), testing::ElementsAre(0.125F, 1.0F));
  EXPECT_THAT(frame_weights(std::vector<double>{7}, std::vector<double>{3}, 5), testing::ElementsAre(1.0F));
  EXPECT_THAT(frame_weights(costs, std::vector<double>{0, 2}, 0), testing::ElementsAre(1.0F, 0.5F)) << "a root of measure 0";
  EXPECT_DOUBLE_EQ(animation_cost(costs, 0), 15);
  EXPECT_DOUBLE_EQ(animation_cost(costs, 1), 500.0 / 30);
  EXPECT_DOUBLE_EQ(animation_cost(costs, 1000), 20) << "no overflow";
}

TEST(Tsah, ParametersOutOfRangeAreRefused) {
  const test::TempFolder folder;
  const std::string file =
      folder.write("x.yaml",
                   "scenes: [terrain: {triangles: 1000}]\nanimation: {}\nmethods:\n"
                   "  a: {builder: sweep-sah, update: refit, optimize: [tsah: {exponent: -2, frames: 0}]}\n"
                   "  b: {builder: sweep-sah, update: refit, optimize: [compaction: {exponent: -0.5, frames: -1}]}\n"
                   "  c: {builder: sweep-sah, update: refit, optimize: [tsah: {exponent: .nan, frames: 65}]}\n");
  EXPECT_EQ(
      test::error_of([&] { (void)read_plan(file, Scale::quick); }),
      fmt::format("{0}:4:70: optimizer 'tsah': parameter 'exponent' is the integer -2; expected a number in [0, 1000]\n"
                  "{0}:4:82: optimizer 'tsah': parameter 'frames' is the integer 0; expected an integer in [1, 64]\n"
                  "{0}:5:76: optimizer 'compaction': parameter 'exponent' is the number -0.5; expected a number in [0, 1000]\n"
                  "{0}:5:90: optimizer 'compaction': parameter 'frames' is the integer -1; expected an integer in [0, 64]\n"
                  "{0}:6:70: optimizer 'tsah': parameter 'exponent' is the text '.nan'; expected a number in [0, 1000]\n"
                  "{0}:6:84: optimizer 'tsah': parameter 'frames' is the integer 65; expected an integer in [1, 64]",
                  file));
}

}  // namespace
}  // namespace raystudy::tsah
