#include <gmock/gmock.h>

#include <limits>

#include "harness/accel/refit.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/refit_session.h"
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

}  // namespace
}  // namespace raystudy::updates
