#include <gmock/gmock.h>

#include <algorithm>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "harness/vulkan/device.h"
#include "tests/support/animated.h"
#include "tests/support/same_tree.h"
#include "tests/support/test_name.h"

namespace raystudy {
namespace {

/// What every updater owes, whatever it does.
class EveryUpdater : public testing::TestWithParam<std::string> {
 protected:
  static constexpr std::size_t frame_count = 7;

  void SetUp() override {
    if (Registry::instance().get(Role::updater, GetParam()).info.on_device && vulkan::list_devices().empty()) {
      GTEST_SKIP() << "there is no Vulkan device on this machine";
    }
  }

  [[nodiscard]] static std::unique_ptr<UpdateSession> prepare(const Scene& scene, int threads = 1) {
    const Registry& registry = Registry::instance();
    const auto updater = registry.create<Updater>(registry.ref(Role::updater, GetParam()));
    BuildContext context;
    context.threads = threads;
    const std::shared_ptr<Builder> builder = registry.create<Builder>(registry.ref(Role::builder, "sweep-sah"));
    const TreeBuild build = [builder, context](const Scene& frame) { return builder->build(frame, context); };
    return updater->prepare(scene, uniform_times(frame_count), build, context);
  }
  [[nodiscard]] static Bvh2 updated(UpdateSession& session, const Scene& scene, std::size_t f) {
    const FrameUpdate update = session.update(scene_at(scene, uniform_times(frame_count)[f]), f);
    return dynamic_cast<const Bvh2&>(*update.accel);
  }
};

INSTANTIATE_TEST_SUITE_P(All, EveryUpdater, testing::ValuesIn(Registry::instance().names(Role::updater)), test::test_name);

TEST_P(EveryUpdater, GivesAValidTreeForEveryFrame) {
  for (const std::size_t count : {1U, 2U, 3U, 500U}) {
    const Scene scene = test::crossing_boxes(count, 4, 1);
    const auto session = prepare(scene);
    for (std::size_t f = 0; f < frame_count; ++f) {
      const Bvh2 tree = updated(*session, scene, f);
      EXPECT_THAT(find_problems(tree, scene_at(scene, uniform_times(frame_count)[f])), testing::IsEmpty())
          << count << " triangles, frame " << f;
    }
    EXPECT_GT(session->bytes(), 0U);
  }
}

TEST_P(EveryUpdater, PlaysTheSameAgainAndOnAnyNumberOfThreads) {
  const Scene scene = test::crossing_boxes(3000, 5, 2);
  const auto one = prepare(scene, 1);
  const auto two = prepare(scene, 2);
  std::vector<Bvh2> first;
  for (std::size_t f = 0; f < frame_count; ++f) {
    first.push_back(updated(*one, scene, f));
    EXPECT_TRUE(test::same(first.back(), updated(*two, scene, f))) << "frame " << f;
  }
  for (std::size_t f = 0; f < frame_count; ++f)
    EXPECT_TRUE(test::same(first[f], updated(*one, scene, f))) << "again, frame " << f;
}

/// Whether the updater goes on improving the tree of a scene in which nothing moves.
bool improves_trees(const std::string& name) { return name == "refit-rotations"; }

TEST_P(EveryUpdater, AStaticSceneStandsStill) {
  const Scene scene = test::scene_of(test::random_boxes(100, 3));
  const auto session = prepare(scene);
  const Bvh2 first = updated(*session, scene, 0);
  const Bvh2 second = updated(*session, scene, 1);
  if (improves_trees(GetParam())) {
    EXPECT_LE(tree_cost(second, {}), tree_cost(first, {}));
  } else {
    EXPECT_TRUE(test::same(first, second));
  }
}

}  // namespace
}  // namespace raystudy
