#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "methods/vulkan/trace_session.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/trees.h"

namespace raystudy::gpu {
namespace {

using test::random_rays;
using test::soup;
using vulkan::Device;

class DeviceTrace : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
  static Device& device() { return Device::shared(); }
};

/// As the device likes it, as GPUs do; stacks of one kind and the other, at hand for the most part or hardly at all; the last
/// with so few steps that most rays take several dispatches.
std::vector<TraceShape> shapes() {
  const TraceShape usual = trace_shape_of(Device::shared());
  const std::uint32_t steps = usual.step_limit;
  return {usual, {64, false, 0, true, 16, steps}, {8, true, 3, true, 2, steps}, {16, true, 5, false, 1, 50}};
}

std::vector<Hit> trace(const TraceShape& shape, const Bvh2& bvh, const Scene& scene, std::span<const Ray> rays, Query query) {
  GpuTraceSession session(Device::shared(), bvh, scene, shape);
  std::vector<Hit> hits(rays.size(), Hit{1, 1, 1, 1});
  session.trace(rays, hits, query);
  return hits;
}

TEST_F(DeviceTrace, HitsAreThoseOfTestingEveryTriangle) {
  const Scene scene = soup(300, 0.3F, 1);
  const std::vector<Ray> rays = random_rays(3000, 2);
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    const Bvh2 tree = test::random_tree(scene, seed, seed % 3 == 0 ? 1 : 5);
    for (const TraceShape& shape : shapes()) {
      test::expect_same(expected, trace(shape, tree, scene, rays, Query::closest_hit));
      const std::vector<Hit> any = trace(shape, tree, scene, rays, Query::any_hit);
      for (std::size_t i = 0; i < any.size(); ++i) ASSERT_EQ(expected[i].is_hit(), any[i].is_hit()) << "ray " << i;
    }
  }
}

/// Directions of extreme length, which are brought near 1, and some with components that underflow.
TEST_F(DeviceTrace, HitsOfRaysOfExtremeLengthAreThoseOfTestingEveryTriangle) {
  const Scene scene = soup(300, 0.3F, 1);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  for (const float length : {1e-37F, 1e-20F, 1e25F, 1e38F}) {
    std::vector<Ray> rays = random_rays(1000, 3);
    for (Ray& ray : rays) {
      ray.direction = ray.direction * length;
      ray.tmin = 0;
      ray.tmax = std::numeric_limits<float>::infinity();
    }
    test::expect_same(test::closest_hits(scene, rays), trace(trace_shape_of(device()), tree, scene, rays, Query::closest_hit));
  }
}

TEST_F(DeviceTrace, EqualDistancesGoToTheLowestTriangle) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
  scene.triangles = SharedArray<Triangle>(std::vector<Triangle>(40, Triangle{{0, 1, 2}}));
  finish_scene(scene, "forty times one triangle");
  const std::vector<Ray> rays(1, Ray{{0, 0, -1}, 0, {0, 0, 1}});
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Bvh2 tree = test::random_tree(scene, seed, 2);
    const std::vector<Hit> hits = trace(trace_shape_of(device()), tree, scene, rays, Query::closest_hit);
    EXPECT_EQ(hits[0].triangle, 0U);
    EXPECT_EQ(hits[0].t, 1.0F);
  }
}

TEST_F(DeviceTrace, CountsAreThoseOfTheScalarTracer) {
  const Scene scene = soup(500, 0.2F, 3);
  const Bvh2 tree = test::random_tree(scene, 1, 3);
  const std::vector<Ray> rays = random_rays(2000, 5);
  const auto scalar =
      Registry::instance().create<Tracer>(Registry::instance().ref(Role::tracer, "scalar"))->prepare(tree, scene, 1, false);
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    std::vector<std::uint32_t> expected_steps(rays.size());
    const TraceCounts expected = scalar->count(rays, query, expected_steps);
    for (const TraceShape& shape : shapes()) {
      GpuTraceSession session(device(), tree, scene, shape);
      std::vector<std::uint32_t> steps(rays.size());
      const TraceCounts counts = session.count(rays, query, steps);
      EXPECT_EQ(steps, expected_steps);
      EXPECT_EQ(counts.inner_nodes, expected.inner_nodes);
      EXPECT_EQ(counts.leaves, expected.leaves);
      EXPECT_EQ(counts.box_tests, expected.box_tests);
      EXPECT_EQ(counts.triangle_tests, expected.triangle_tests);
    }
  }
}

/// A stack of triangles along z, and the tree in which every inner node has the farthest as a leaf and the rest.
TEST_F(DeviceTrace, ATreeAsDeepAsItHasLeaves) {
  constexpr std::uint32_t depth = 20000;
  std::vector<Box> boxes;
  for (std::uint32_t i = 0; i < depth; ++i) {
    const auto z = static_cast<float>(i);
    boxes.emplace_back(Vec3{0, 0, z}, Vec3{1, 1, z});
  }
  const Scene scene = test::scene_of(boxes);
  Bvh2 bvh;
  bvh.triangles.resize(depth);
  std::iota(bvh.triangles.begin(), bvh.triangles.end(), 0U);
  bvh.nodes.resize(2 * std::size_t{depth});
  Box box;
  for (std::uint32_t i = 0; i < depth; ++i) {  // the subtree of triangles 0 to i; its children are at the pair depth - i
    box.extend(boxes[i]);
    const std::uint32_t slot = i + 1 < depth ? 2 * (depth - 1 - i) : 0;
    bvh.nodes[slot] = i == 0 ? test::leaf(box, 0) : test::inner(box, 2 * (depth - i));
    if (i > 0) bvh.nodes[2 * (depth - i) + 1] = test::leaf(boxes[i], i);
  }
  ASSERT_TRUE(find_problems(bvh, scene).empty());
  const std::vector<Ray> rays{{{0.1F, 0.2F, -1}, 0, {0, 0, 1}}, {{0.1F, 0.2F, depth}, 0, {0, 0, -1}}};
  for (const TraceShape& shape : shapes()) {
    const std::vector<Hit> hits = trace(shape, bvh, scene, rays, Query::closest_hit);
    EXPECT_EQ(hits[0].triangle, 0U);
    EXPECT_EQ(hits[1].triangle, depth - 1);
  }
}

TEST_F(DeviceTrace, EmptyTreeAndInvalidRaysHitNothing) {
  const Scene scene = soup(10, 1, 1);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  const std::vector<Ray> rays = test::invalid_rays();
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    const TraceShape shape = trace_shape_of(device());
    for (const Hit& hit : trace(shape, tree, scene, rays, query)) EXPECT_FALSE(hit.is_hit());
    for (const Hit& hit : trace(shape, Bvh2(), scene, rays, query)) EXPECT_FALSE(hit.is_hit());
    EXPECT_TRUE(trace(shape, tree, scene, {}, query).empty());
  }
}

TEST_F(DeviceTrace, TracesInPiecesWhatIsMoreThanAPiece) {
  const Scene scene = soup(20, 0.5F, 4);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  const std::vector<Ray> some = random_rays(1000, 7);
  std::vector<Ray> rays;
  for (int i = 0; i < 300; ++i) rays.insert(rays.end(), some.begin(), some.end());
  const std::vector<Hit> expected = test::closest_hits(scene, some);
  const std::vector<Hit> hits = trace(trace_shape_of(device()), tree, scene, rays, Query::closest_hit);
  for (std::size_t i = 0; i < hits.size(); ++i) ASSERT_EQ(hits[i].t, expected[i % 1000].t) << "ray " << i;
}

TEST_F(DeviceTrace, TellsItsTimes) {
  const Scene scene = soup(300, 0.3F, 1);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  GpuTraceSession session(device(), tree, scene, trace_shape_of(device()));
  const std::vector<Ray> rays = random_rays(500, 7);
  std::vector<Hit> hits(rays.size());
  session.trace(rays, hits, Query::closest_hit);
  const DeviceTimes& times = *session.device_times();
  EXPECT_GT(times.seconds.value_or(0), 0);
  EXPECT_GT(times.upload, 0);
  EXPECT_GT(times.download, 0);
  EXPECT_GT(times.peak_bytes, rays.size() * (sizeof(Ray) + sizeof(Hit)));
}

}  // namespace
}  // namespace raystudy::gpu
