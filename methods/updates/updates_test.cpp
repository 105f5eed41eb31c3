#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "harness/accel/refit.h"
#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/degradation.h"
#include "methods/updates/refit_session.h"
#include "harness/vulkan/device.h"
#include "tests/support/animated.h"
#include "tests/support/same_tree.h"

namespace raystudy::updates {
namespace {

constexpr std::size_t frame_count = 5;

std::unique_ptr<Bvh2> sweep(const Scene& scene) {
  const Registry& registry = Registry::instance();
  return take_bvh2(registry.create<Builder>(registry.ref(Role::builder, "sweep-sah"))->build(scene, {}), "test");
}

struct Prepared {
  std::unique_ptr<UpdateSession> session;
  std::size_t builds = 0;
};

void prepare(Prepared& prepared, const Scene& scene, const std::string& name,
             std::map<std::string, ParamValue, std::less<>> changes = {}) {
  const Registry& registry = Registry::instance();
  const auto updater = registry.create<Updater>(registry.ref(Role::updater, name, std::move(changes)));
  const TreeBuild build = [&prepared](const Scene& frame) {
    ++prepared.builds;
    return sweep(frame);
  };
  prepared.session = updater->prepare(scene, uniform_times(frame_count), build, {});
}

Scene frame_of(const Scene& scene, std::size_t f) { return scene_at(scene, uniform_times(frame_count)[f]); }

TEST(Rebuild, BuildsBeforeOrEachFrame) {
  const Scene scene = test::crossing_boxes(200, 4, 1);
  for (const bool before : {true, false}) {
    Prepared prepared;
    prepare(prepared, scene, "rebuild", {{"when", std::string(before ? "before" : "each-frame")}});
    EXPECT_EQ(prepared.builds, before ? frame_count : 0);
    for (std::size_t f = 0; f < frame_count; ++f) {
      const FrameUpdate update = prepared.session->update(frame_of(scene, f), f);
      EXPECT_EQ(update.rebuilt, !before);
      EXPECT_TRUE(test::same(dynamic_cast<const Bvh2&>(*update.accel), *sweep(frame_of(scene, f))));
    }
    EXPECT_EQ(prepared.builds, frame_count);
  }
}

TEST(Refit, KeepsTheFirstFramesTree) {
  const Scene scene = test::crossing_boxes(200, 4, 1);
  Prepared prepared;
  prepare(prepared, scene, "refit");
  EXPECT_EQ(prepared.builds, 1U);
  const auto first = sweep(scene);
  const FrameUpdate update = prepared.session->update(frame_of(scene, 3), 3);
  EXPECT_FALSE(update.rebuilt);
  const auto& tree = dynamic_cast<const Bvh2&>(*update.accel);
  EXPECT_EQ(tree.triangles, first->triangles);
  EXPECT_NE(tree.nodes[0].box, first->nodes[0].box);
}

TEST(BestOverTime, IsTheTreeOfLeastMeanCost) {
  const Scene scene = test::crossing_boxes(300, 4, 5);
  double least = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> best;
  for (std::size_t own = 0; own < frame_count; ++own) {
    const auto tree = sweep(frame_of(scene, own));
    double sum = 0;
    for (std::size_t f = 0; f < frame_count; ++f) {
      Refitter(*tree, scene.triangles, RefitMethod::serial, 1).refit(*tree, frame_of(scene, f).vertices);
      sum += tree_cost(*tree, {});
    }
    if (sum >= least) continue;
    least = sum;
    best = tree->triangles;
  }
  Prepared prepared;
  prepare(prepared, scene, "best-over-time");
  EXPECT_EQ(prepared.builds, frame_count);
  EXPECT_EQ(dynamic_cast<const Bvh2&>(*prepared.session->update(frame_of(scene, 0), 0).accel).triangles, best);
  EXPECT_NE(best, sweep(scene)->triangles) << "a case where the first frame is not the best";
}

/// Two bars of half area 3 each, the second at `at`; their parent's half area is 2 (at + 1) + 1.
Bvh2 two_bars(float at) {
  Bvh2 bvh;
  bvh.nodes = {test::inner(test::bar(0, at + 1), 2), {}, test::leaf(test::bar(0, 1), 0), test::leaf(test::bar(at, at + 1), 1)};
  bvh.triangles = {0, 1};
  return bvh;
}

TEST(Degradation, IsTheMeanGrowthOfTheRatioOfAreas) {
  const Degradation since(two_bars(2), 1);
  EXPECT_DOUBLE_EQ(since.of(two_bars(2)), 0);
  EXPECT_NEAR(since.of(two_bars(8)), 19.0 / 6 - 7.0 / 6, 1e-6);
  EXPECT_NEAR(since.of(two_bars(1)), 5.0 / 6 - 7.0 / 6, 1e-6) << "better than built";
}

TEST(Degradation, NodesWithoutAreaAddNothing) {
  Bvh2 points = two_bars(2);
  for (Bvh2Node& node : points.nodes) node.box = Box{{1, 1, 1}, {1, 1, 1}};
  EXPECT_EQ(Degradation(points, 1).of(two_bars(8)), 0);
  EXPECT_EQ(Degradation(two_bars(8), 1).of(points), 0);
  EXPECT_EQ(Degradation({}, 1).of({}), 0);
}

TEST(Degradation, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene = test::crossing_boxes(20000, 2, 1);
  const auto tree = sweep(scene);
  const Degradation one(*tree, 1);
  const Degradation two(*tree, 2);
  Refitter(*tree, scene.triangles, RefitMethod::serial, 1).refit(*tree, scene.frames[1]);
  EXPECT_GT(one.of(*tree), 0.1);
  EXPECT_EQ(one.of(*tree), two.of(*tree));
}

/// For each frame of the animation whether its tree was built for it.
std::vector<bool> rebuilt_frames(const Scene& scene, std::map<std::string, ParamValue, std::less<>> changes) {
  Prepared prepared;
  prepare(prepared, scene, "refit-or-rebuild", std::move(changes));
  std::vector<bool> rebuilt;
  for (std::size_t f = 0; f < frame_count; ++f) {
    const FrameUpdate update = prepared.session->update(frame_of(scene, f), f);
    rebuilt.push_back(update.rebuilt);
    if (update.rebuilt) {
      EXPECT_TRUE(test::same(dynamic_cast<const Bvh2&>(*update.accel), *sweep(frame_of(scene, f))));
    }
  }
  EXPECT_EQ(prepared.builds, 1U + static_cast<std::size_t>(std::count(rebuilt.begin(), rebuilt.end(), true)));
  return rebuilt;
}

TEST(RefitOrRebuild, RebuildsWhereTrianglesMixAndNotWhereTheyMoveTogether) {
  const Scene mixing = test::crossing_boxes(300, 4, 1);
  const std::vector<bool> by_criterion = rebuilt_frames(mixing, {});
  EXPECT_FALSE(by_criterion[0]);
  EXPECT_TRUE(by_criterion[1]);
  EXPECT_THAT(rebuilt_frames(mixing, {{"threshold", 1e6}}), testing::Each(false));

  Scene together = mixing;
  for (std::size_t f = 0; f < together.frames.size(); ++f) {
    std::vector<Vec3> positions(mixing.vertices.begin(), mixing.vertices.end());
    for (Vec3& p : positions) p = p * (1.0F + static_cast<float>(f)) + Vec3{static_cast<float>(f), 0, 0};
    together.frames[f] = SharedArray<Vec3>(std::move(positions));
  }
  EXPECT_THAT(rebuilt_frames(together, {}), testing::Each(false));
}

TEST(RefitOrRebuild, RebuildsEveryThatManyFrames) {
  const Scene scene = test::crossing_boxes(100, 4, 1);
  EXPECT_THAT(rebuilt_frames(scene, {{"every", std::int64_t{2}}}), testing::ElementsAre(false, false, true, false, true));
  EXPECT_THAT(rebuilt_frames(scene, {{"every", std::int64_t{100}}}), testing::Each(false));
}

TEST(RefitOrRebuild, HoldsTheFirstTreeAndTheLast) {
  const Scene scene = test::crossing_boxes(300, 4, 1);
  Prepared prepared;
  prepare(prepared, scene, "refit-or-rebuild", {{"every", std::int64_t{1}}});
  const std::size_t first = prepared.session->bytes();
  (void)prepared.session->update(frame_of(scene, 1), 1);
  EXPECT_NEAR(static_cast<double>(prepared.session->bytes()), 2.0 * static_cast<double>(first), 0.1 * static_cast<double>(first));
  (void)prepared.session->update(frame_of(scene, 0), 0);
  EXPECT_EQ(prepared.session->bytes(), first);
}

/// What the updater must come to: boxes, then one pass of hill climbing with the same rotations.
void refit_and_climb(Bvh2& bvh, const Scene& frame) {
  Refitter(bvh, frame.triangles, RefitMethod::serial, 1).refit(bvh, frame.vertices);
  const Registry& registry = Registry::instance();
  registry.create<Optimizer>(registry.ref(Role::optimizer, "rotation-hill-climbing", {{"max_passes", std::int64_t{1}}}))
      ->optimize(bvh, frame, {});
}

TEST(RefitRotations, IsARefitAndAPassOfHillClimbingInOne) {
  const Scene scene = test::crossing_boxes(5000, 4, 1);
  for (const int threads : {1, 2}) {
    BuildContext context;
    context.threads = threads;
    const Registry& registry = Registry::instance();
    const auto session = registry.create<Updater>(registry.ref(Role::updater, "refit-rotations"))
                             ->prepare(scene, uniform_times(frame_count), sweep, context);
    const auto expected = sweep(scene);
    const auto refitted = sweep(scene);
    for (std::size_t f = 0; f < frame_count; ++f) {
      const Scene frame = frame_of(scene, f);
      refit_and_climb(*expected, frame);
      const auto& tree = dynamic_cast<const Bvh2&>(*session->update(frame, f).accel);
      ASSERT_TRUE(test::same(tree, *expected)) << "frame " << f;
      Refitter(*refitted, scene.triangles, RefitMethod::serial, 1).refit(*refitted, frame.vertices);
      if (f > 0) {
        EXPECT_LT(tree_cost(tree, {}), tree_cost(*refitted, {})) << "frame " << f;
      }
    }
  }
}

/// The costs of all frames, and in which of them the tree is another than in the frame before.
struct Play {
  std::vector<double> costs{};
  std::vector<std::size_t> borders{};
  std::size_t builds = 0;
};

Play play(const Scene& scene, const std::string& updater, std::map<std::string, ParamValue, std::less<>> changes = {}) {
  Prepared prepared;
  prepare(prepared, scene, updater, std::move(changes));
  Play result{.builds = prepared.builds};
  const Accel* tree = nullptr;
  for (std::size_t f = 0; f < frame_count; ++f) {
    const FrameUpdate update = prepared.session->update(frame_of(scene, f), f);
    EXPECT_FALSE(update.rebuilt);
    if (f > 0 && update.accel != tree) result.borders.push_back(f);
    tree = update.accel;
    result.costs.push_back(tree_cost(dynamic_cast<const Bvh2&>(*tree), {}));
  }
  return result;
}

double sum(const std::vector<double>& costs) { return std::accumulate(costs.begin(), costs.end(), 0.0); }

TEST(Parts, OnePartIsRefitAndAsManyAsFramesAreRebuild) {
  const Scene scene = test::crossing_boxes(200, 4, 1);
  EXPECT_EQ(play(scene, "parts", {{"count", std::int64_t{1}}}).costs, play(scene, "refit").costs);
  EXPECT_EQ(play(scene, "parts", {{"count", std::int64_t{100}}}).costs, play(scene, "rebuild").costs);
}

TEST(Parts, AreBuiltOnTheirOwnFrames) {
  const Scene scene = test::crossing_boxes(200, 4, 1);
  const Play parts = play(scene, "parts", {{"count", std::int64_t{2}}});
  EXPECT_EQ(parts.builds, 2U);
  EXPECT_THAT(parts.borders, testing::ElementsAre(2));
  // The first frame of each part has the tree that is built for it alone.
  const Play rebuilt = play(scene, "rebuild");
  EXPECT_EQ(parts.costs[2], rebuilt.costs[2]);
  EXPECT_GT(parts.costs[3], rebuilt.costs[3]);

  std::vector<std::size_t> key_frames;
  const TreeBuild build = [&](const Scene& part) {
    key_frames.push_back(part.frames.size());
    return sweep(part);
  };
  const Registry& registry = Registry::instance();
  const auto updater = registry.create<Updater>(registry.ref(Role::updater, "parts", {{"count", std::int64_t{2}}}));
  (void)updater->prepare(scene, uniform_times(frame_count), build, {});
  EXPECT_THAT(key_frames, testing::ElementsAre(2, 3)) << "a quarter and a half of 4 key frames";
}

/// All boxes change places at once between two of the frames.
Scene sudden_change(std::size_t frame) {
  Scene scene = test::crossing_boxes(200, frame_count, 1);
  for (std::size_t f = 0; f < frame_count; ++f) scene.frames[f] = f < frame ? scene.frames[0] : scene.frames[frame_count - 1];
  scene.vertices = scene.frames[0];
  return scene;
}

TEST(Parts, OptimalBordersAreWhereTheSceneChanges) {
  for (const std::size_t change : {1U, 4U}) {
    const Scene scene = sudden_change(change);
    const Play optimal = play(scene, "parts", {{"split", std::string("optimal")}, {"count", std::int64_t{2}}});
    EXPECT_THAT(optimal.borders, testing::ElementsAre(change));
    EXPECT_LT(sum(optimal.costs), sum(play(scene, "parts", {{"count", std::int64_t{2}}}).costs));
  }
}

TEST(Parts, BoundTakesTheFewestThatKeepIt) {
  const Scene scene = sudden_change(3);
  const auto bound = [&](double max_cost) {
    return play(scene, "parts", {{"split", std::string("bound")}, {"max_cost", max_cost}});
  };
  EXPECT_THAT(bound(1e6).borders, testing::IsEmpty());
  EXPECT_THAT(bound(1.01).borders, testing::ElementsAre(3));
  const Scene mixing = test::crossing_boxes(200, 4, 1);
  const Play rebuilt = play(mixing, "rebuild");
  const Play kept = play(mixing, "parts", {{"split", std::string("bound")}, {"max_cost", 1.3}});
  EXPECT_FALSE(kept.borders.empty());
  for (std::size_t f = 0; f < frame_count; ++f) EXPECT_LE(kept.costs[f], 1.3 * rebuilt.costs[f]);
}

TEST(Parts, SaysWhichFrameNoSplitKeepsWithinTheBound) {
  try {
    (void)play(sudden_change(1), "parts", {{"split", std::string("bound")}, {"steps", std::int64_t{2}}, {"max_cost", 1.25}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                testing::MatchesRegex("updater 'parts': frame 1 costs [0-9.]+ times its own tree's with a tree for "
                                      "frames 0 to 1, the shortest part that 2 steps allow; expected more steps, or "
                                      "a larger max_cost than 1.25"));
  }
}

TEST(Updaters, SayWhatTheyNeed) {
  const Registry& registry = Registry::instance();
  const Scene scene = test::crossing_boxes(10, 2, 1);
  const TreeBuild build = [&](const Scene& frame) {
    return registry.create<Builder>(registry.ref(Role::builder, "embree"))->build(frame, {});
  };
  for (const std::string& name : registry.names(Role::updater)) {
    if (name == "rebuild") continue;
    if (registry.get(Role::updater, name).info.on_device && vulkan::list_devices().empty()) continue;
    try {
      (void)registry.create<Updater>(registry.ref(Role::updater, name))->prepare(scene, uniform_times(2), build, {});
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()), "updater '" + name + "' got a tree of kind 'embree'; expected a builder of 'bvh2'");
    }
  }
}

}  // namespace
}  // namespace raystudy::updates
