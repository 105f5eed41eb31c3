#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "harness/base/error.h"
#include "harness/geometry/sampling.h"
#include "harness/method/registry.h"
#include "tests/support/brute_force.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

/// A square of edge 4 in the plane z = 0, seen from z = 2 by the camera `front`, with a roof of edge 1 at z = 0.5 above one
/// corner.
Scene floor_and_roof() {
  Scene scene;
  scene.vertices =
      SharedArray<Vec3>({{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}, {1, 1, 0.5F}, {2, 1, 0.5F}, {2, 2, 0.5F}, {1, 2, 0.5F}});
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{0, 2, 3}}, {{4, 5, 6}}, {{4, 6, 7}}});
  scene.cameras = {{.name = "front", .eye = {0, 0, 2}, .target = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 90}};
  finish_scene(scene, "floor and roof");
  return scene;
}

RayBatch generate(const std::string& name, const Scene& scene, Changes changes = {}, std::uint64_t seed = 1) {
  const Registry& registry = Registry::instance();
  const auto workload = registry.create<Workload>(registry.ref(Role::workload, name, std::move(changes)));
  return workload->generate(scene, {seed, [&](auto rays, auto hits) { test::closest_hits(scene, rays, hits); }});
}

TEST(Primary, CornersAndOrderByHand) {
  // Two by two pixels of a 90 degree view: centres at ±1/2 of the plane at distance 1, the first at the top left.
  const RayBatch batch = generate("primary", floor_and_roof(), {{"width", std::int64_t{2}}, {"height", std::int64_t{2}}});
  ASSERT_EQ(batch.rays.size(), 4U);
  EXPECT_EQ(batch.query, Query::closest_hit);
  EXPECT_TRUE(batch.coherent);
  EXPECT_THAT(batch.ray_pixels, testing::ElementsAre(0, 1, 2, 3));
  const Vec3 expected[4] = {{-0.5F, 0.5F, -1}, {0.5F, 0.5F, -1}, {-0.5F, -0.5F, -1}, {0.5F, -0.5F, -1}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(batch.rays[i].origin, (Vec3{0, 0, 2}));
    EXPECT_LT(length(batch.rays[i].direction - normalized(expected[i])), 1e-6F);
  }
}

TEST(Primary, WidthWidensTheView) {
  const RayBatch batch = generate("primary", floor_and_roof(), {{"width", std::int64_t{4}}, {"height", std::int64_t{2}}});
  const auto left =
      static_cast<std::size_t>(std::find(batch.ray_pixels.begin(), batch.ray_pixels.end(), 0U) - batch.ray_pixels.begin());
  EXPECT_LT(length(batch.rays[left].direction - normalized(Vec3{-1.5F, 0.5F, -1})), 1e-6F);
}

TEST(Primary, TilesAndLinesHoldTheSameRays) {
  const Changes size{{"width", std::int64_t{21}}, {"height", std::int64_t{10}}};
  Changes lines = size;
  lines["order"] = std::string("lines");
  const RayBatch a = generate("primary", floor_and_roof(), size);
  const RayBatch b = generate("primary", floor_and_roof(), lines);
  ASSERT_EQ(a.rays.size(), 210U);
  for (std::size_t i = 0; i < b.rays.size(); ++i) ASSERT_EQ(b.ray_pixels[i], i);
  EXPECT_EQ(std::set<std::uint32_t>(a.ray_pixels.begin(), a.ray_pixels.end()).size(), 210U);
  for (std::size_t i = 0; i < a.rays.size(); ++i) ASSERT_EQ(a.rays[i].direction, b.rays[a.ray_pixels[i]].direction);
  // The first 16 rays are a block of 4 by 4 pixels.
  for (std::size_t i = 0; i < 16; ++i) {
    EXPECT_LT(a.ray_pixels[i] % 21, 4U);
    EXPECT_LT(a.ray_pixels[i] / 21, 4U);
  }
}

TEST(Primary, SamplesStayInTheirPixel) {
  const Changes changes{{"width", std::int64_t{4}}, {"height", std::int64_t{4}}, {"samples", std::int64_t{50}}};
  const RayBatch batch = generate("primary", floor_and_roof(), changes);
  ASSERT_EQ(batch.rays.size(), 800U);
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Vec3 d = batch.rays[i].direction / -batch.rays[i].direction.z;
    EXPECT_EQ(static_cast<std::uint32_t>((d.x + 1) * 2), batch.ray_pixels[i] % 4);
    EXPECT_EQ(static_cast<std::uint32_t>((1 - d.y) * 2), batch.ray_pixels[i] / 4);
  }
}

TEST(Primary, CameraThatLooksAlongItsUpVector) {
  Scene scene = floor_and_roof();
  scene.cameras[0].up = {0, 0, 1};
  for (const Ray& ray : generate("primary", scene, {{"width", std::int64_t{4}}, {"height", std::int64_t{4}}}).rays) {
    EXPECT_TRUE(is_finite(ray.direction));
    EXPECT_NEAR(length(ray.direction), 1, 1e-6F);
  }
}

TEST(Random, PointsFillTheBoxUniformly) {
  const Scene scene = floor_and_roof();
  const RayBatch batch = generate("random", scene, {{"count", std::int64_t{20000}}, {"segment", true}});
  ASSERT_EQ(batch.rays.size(), 20000U);
  EXPECT_EQ(batch.query, Query::closest_hit);
  EXPECT_FALSE(batch.coherent);
  Vec3 first;
  Vec3 second;
  for (const Ray& ray : batch.rays) {
    EXPECT_EQ(ray.tmax, 1);
    const Vec3 end = ray.origin + ray.direction;
    ASSERT_TRUE(scene.bounds.contains({ray.origin, ray.origin}));
    first += ray.origin / 20000.0F;
    second += end / 20000.0F;
  }
  // The mean of 20000 uniform numbers over [-2, 2] has a standard deviation of 0.008.
  EXPECT_LT(length(first - scene.bounds.center()), 0.05F);
  EXPECT_LT(length(second - scene.bounds.center()), 0.05F);
  EXPECT_EQ(generate("random", scene, {{"count", std::int64_t{1}}}).rays[0].tmax, std::numeric_limits<float>::infinity());
}

TEST(AmbientOcclusion, StartsOffTheSurfaceAndStaysAboveIt) {
  const Scene scene = floor_and_roof();
  const Changes changes{{"width", std::int64_t{20}}, {"height", std::int64_t{20}}, {"length", 0.25}};
  const RayBatch batch = generate("ambient-occlusion", scene, changes);
  EXPECT_EQ(batch.query, Query::any_hit);
  EXPECT_EQ(batch.rays.size(), 4000U);  // every pixel sees the floor or the roof, ten rays each
  ASSERT_EQ(batch.ray_pixels.size(), batch.rays.size());
  float mean_cosine = 0;
  for (const Ray& ray : batch.rays) {
    const bool on_roof = ray.origin.z > 0.4F;
    EXPECT_NEAR(ray.origin.z, on_roof ? 0.5F : 0, 2e-5F);
    EXPECT_GT(ray.origin.z, on_roof ? 0.5F : 0);
    EXPECT_GE(ray.direction.z, 0);
    EXPECT_NEAR(length(ray.direction), 1, 1e-5F);
    EXPECT_FLOAT_EQ(ray.tmax, 0.25F * scene.diagonal());
    mean_cosine += ray.direction.z / static_cast<float>(batch.rays.size());
  }
  EXPECT_NEAR(mean_cosine, 2.0F / 3, 0.02F);  // ∫ cos²θ / π over the hemisphere
}

TEST(AmbientOcclusion, OneOpenSceneIsNotOccludedByItself) {
  Scene scene = floor_and_roof();
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{0, 2, 3}}});
  const RayBatch batch = generate("ambient-occlusion", scene, {{"width", std::int64_t{30}}, {"height", std::int64_t{30}}});
  const std::vector<Hit> hits = test::closest_hits(scene, batch.rays);
  EXPECT_TRUE(std::none_of(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); }));
}

TEST(Workloads, SeedsMatterAndRepeat) {
  const Scene scene = floor_and_roof();
  const Changes count{{"count", std::int64_t{100}}};
  const auto origins = [&](std::uint64_t seed) {
    std::vector<float> xs;
    for (const Ray& ray : generate("random", scene, count, seed).rays) xs.push_back(ray.origin.x);
    return xs;
  };
  EXPECT_EQ(origins(7), origins(7));
  EXPECT_NE(origins(7), origins(8));
}

TEST(Workloads, UnknownCamera) {
  try {
    (void)generate("primary", floor_and_roof(), {{"camera", std::string("fron")}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("did you mean 'front'?"));
  }
}

TEST(IndexedRandom, IsUniform) {
  const IndexedRandom random(1, 0);
  std::vector<int> bins(16);
  for (std::uint64_t i = 0; i < 16000; ++i) ++bins[static_cast<std::size_t>(random.uniform(i) * 16)];
  // 1000 expected in each with a standard deviation of 31.
  for (const int n : bins) EXPECT_NEAR(n, 1000, 155);
}

TEST(Frame, IsOrthonormalEverywhere) {
  for (const Vec3 n : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, normalized(Vec3{1, 2, -3})}) {
    const Frame frame(n);
    EXPECT_NEAR(dot(frame.tangent, n), 0, 1e-6F);
    EXPECT_NEAR(dot(frame.tangent, frame.bitangent), 0, 1e-6F);
    EXPECT_LT(length(cross(frame.tangent, frame.bitangent) - n), 1e-6F);
  }
}

}  // namespace
}  // namespace raystudy
