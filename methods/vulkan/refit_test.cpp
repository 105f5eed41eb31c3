#include "harness/accel/refit.h"

#include <gmock/gmock.h>

#include "harness/accel/node_order.h"
#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/vulkan/device_refit.h"
#include "tests/support/animated.h"
#include "tests/support/same_tree.h"

namespace raystudy::gpu {
namespace {

using vulkan::Device;
using Changes = std::map<std::string, ParamValue, std::less<>>;

class OnDeviceRefit : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
};

constexpr DeviceRefitMethod methods[]{DeviceRefitMethod::atomics, DeviceRefitMethod::levels};

/// Refits `bvh` twice on the device, so that what the first leaves behind is seen.
Bvh2 refitted(const Bvh2& bvh, const Scene& scene, std::span<const Vec3> vertices, DeviceRefitMethod method) {
  Device& device = Device::shared();
  const DeviceRefit refit(device, bvh, {scene.triangles.data(), scene.triangles.size()}, method);
  const vulkan::Buffer positions(device, vertices.size_bytes());
  Bvh2 result = bvh;
  for (const std::span<const Vec3> now : {std::span<const Vec3>(scene.vertices.data(), scene.vertices.size()), vertices}) {
    vulkan::upload(device, positions.all(), now);
    vulkan::Commands commands(device);
    refit.record(commands, positions.all());
    commands.finish();
  }
  vulkan::download(device, refit.nodes(), std::as_writable_bytes(std::span(result.nodes.data(), result.nodes.size())));
  return result;
}

void check(const Bvh2& bvh, const Scene& scene, std::span<const Vec3> vertices) {
  Bvh2 expected = bvh;
  Refitter(expected, {scene.triangles.data(), scene.triangles.size()}, RefitMethod::serial, 1).refit(expected, vertices);
  for (const DeviceRefitMethod method : methods) EXPECT_TRUE(test::same(refitted(bvh, scene, vertices, method), expected));
}

TEST_F(OnDeviceRefit, GivesTheBoxesOfTheProcessorBitForBit) {
  for (const std::size_t count : {1U, 2U, 3U, 10U, 1000U, 20000U}) {
    const Scene before = test::scene_of(test::random_boxes(count, 1));
    const Scene after = test::scene_of(test::random_boxes(count, 77));
    for (const std::uint32_t leaf_triangles : {1U, 5U}) {
      check(test::random_tree(before, 1, leaf_triangles), before, after.vertices);
    }
  }
}

/// Zeros of both signs, between which minimum and maximum choose by their order.
TEST_F(OnDeviceRefit, GivesTheZerosOfTheProcessor) {
  const Scene scene = test::scene_of(test::random_boxes(2000, 1));
  std::vector<Vec3> zeros;
  for (std::size_t i = 0; i < scene.vertices.size(); ++i) zeros.emplace_back(i % 3 == 0 ? -0.0F : 0.0F);
  check(test::random_tree(scene, 1, 2), scene, zeros);
}

TEST_F(OnDeviceRefit, WorksWhereverNodesLie) {
  const Scene before = test::scene_of(test::random_boxes(5000, 1));
  const Scene after = test::scene_of(test::random_boxes(5000, 77));
  for (const std::string& order : node_order_names()) {
    Bvh2 bvh = test::random_tree(before, 1, 2);
    arrange(bvh, node_order(order), Pages::normal);
    check(bvh, before, after.vertices);
  }
}

TEST_F(OnDeviceRefit, OfAnEmptyTreeDoesNothing) {
  const Scene scene = test::scene_of(test::random_boxes(1, 1));
  for (const DeviceRefitMethod method : methods) EXPECT_TRUE(refitted(Bvh2(), scene, scene.vertices, method).empty());
}

TEST_F(OnDeviceRefit, RefusesLeavesThatTakeTooManySteps) {
  const Scene scene = test::scene_of(std::vector<Box>(20000, Box{{0, 0, 0}, {1, 1, 1}}));
  Bvh2 bvh;
  bvh.nodes = {{scene.bounds, 0, 20000}, {}};
  bvh.triangles.resize(20000);
  EXPECT_THAT(
      [&] { refitted(bvh, scene, scene.vertices, DeviceRefitMethod::levels); },
      testing::ThrowsMessage<Error>("refitting on a device: leaves of up to 20000 triangles; expected 4 times the triangles "
                                    "and, with atomics, the levels to be 65000 at most"));
}

TEST_F(OnDeviceRefit, TakesTheTreeThatIsBestOverTime) {
  const Registry& registry = Registry::instance();
  const Scene animation = test::crossing_boxes(300, 4, 1);
  const std::shared_ptr<Builder> builder = registry.create<Builder>(registry.ref(Role::builder, "binned-sah"));
  const TreeBuild build = [&](const Scene& scene) { return builder->build(scene, {}); };
  const std::vector<double> times = uniform_times(3);
  const auto tree_of = [&](const MethodRef& ref) {
    const auto session = registry.create<Updater>(ref)->prepare(animation, times, build, {});
    return dynamic_cast<const Bvh2&>(*session->update(scene_at(animation, 0), 0).accel);
  };
  const Bvh2 best = tree_of(registry.ref(Role::updater, "gpu-refit", {{"tree", std::string("best")}}));
  EXPECT_TRUE(test::same(best, tree_of(registry.ref(Role::updater, "best-over-time"))));
  EXPECT_FALSE(test::same(best, tree_of(registry.ref(Role::updater, "gpu-refit"))));
}

/// Frames on key frames and between them: interpolated on the device or by the host, refitted by either method.
TEST_F(OnDeviceRefit, UpdaterFollowsAnAnimationAsRefitDoes) {
  const Registry& registry = Registry::instance();
  const Scene animation = test::crossing_boxes(3000, 4, 1);
  const std::shared_ptr<Builder> builder = registry.create<Builder>(registry.ref(Role::builder, "binned-sah"));
  const TreeBuild build = [&](const Scene& scene) { return builder->build(scene, {}); };
  const std::vector<double> times = uniform_times(8);
  const auto prepare = [&](const std::string& name, const Changes& changes) {
    return registry.create<Updater>(registry.ref(Role::updater, name, changes))->prepare(animation, times, build, {});
  };
  const auto expected = prepare("refit", {});
  for (const std::string method : {"atomics", "levels"}) {
    for (const std::string interpolate : {"device", "host"}) {
      const auto session = prepare("gpu-refit", {{"method", method}, {"interpolate", interpolate}});
      for (std::size_t f = 0; f < times.size(); ++f) {
        const Scene frame = scene_at(animation, times[f]);
        const FrameUpdate update = session->update(frame, f);
        EXPECT_GT(update.device_seconds.value_or(0), 0);
        EXPECT_FALSE(update.rebuilt);
        EXPECT_TRUE(
            test::same(dynamic_cast<const Bvh2&>(*update.accel), dynamic_cast<const Bvh2&>(*expected->update(frame, f).accel)))
            << method << ", " << interpolate << ", frame " << f;
      }
    }
  }
}

}  // namespace
}  // namespace raystudy::gpu
