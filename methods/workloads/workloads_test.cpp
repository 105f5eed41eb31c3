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

TEST(Shadow, RaysEndJustBeforePointLightsAndGoOnToDirectionalOnes) {
  Scene scene = floor_and_roof();
  scene.lights = {{.name = "lamp", .position = {0.5F, -0.5F, 1}},
                  {.name = "sun", .position = {0, 3, 4}, .point_at_infinity = true}};
  const RayBatch batch = generate("shadow", scene, {{"width", std::int64_t{20}}, {"height", std::int64_t{20}}});
  EXPECT_EQ(batch.query, Query::any_hit);
  ASSERT_EQ(batch.rays.size(), 800U);  // every pixel sees the floor or the roof, two rays each
  ASSERT_EQ(batch.ray_pixels.size(), 800U);
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Ray& ray = batch.rays[i];
    EXPECT_EQ(batch.ray_pixels[i], batch.ray_pixels[i - i % 2]);
    EXPECT_GT(ray.origin.z, ray.origin.z > 0.4F ? 0.5F : 0);
    if (i % 2 == 0) {
      EXPECT_LT(length(ray.origin + ray.direction - Vec3{0.5F, -0.5F, 1}), 1e-6F);
      EXPECT_GT(ray.tmax, 0.998F);
      EXPECT_LT(ray.tmax, 1);
    } else {
      EXPECT_LT(length(ray.direction - Vec3{0, 0.6F, 0.8F}), 1e-6F);
      EXPECT_EQ(ray.tmax, std::numeric_limits<float>::infinity());
    }
  }
}

TEST(Shadow, RadiusSpreadsTheRaysOverASphere) {
  Scene scene = floor_and_roof();
  scene.lights = {{.name = "lamp", .position = {0, 0, 4}}};
  const Changes changes{{"width", std::int64_t{30}}, {"height", std::int64_t{30}}, {"radius", 0.1}, {"rays", std::int64_t{4}}};
  const RayBatch batch = generate("shadow", scene, changes);
  ASSERT_EQ(batch.rays.size(), 3600U);
  Vec3 mean;
  for (const Ray& ray : batch.rays) {
    const Vec3 from_centre = ray.origin + ray.direction - scene.lights[0].position;
    EXPECT_NEAR(length(from_centre), 0.1F * scene.diagonal(), 1e-5F);
    mean += from_centre / (3600 * 0.1F * scene.diagonal());
  }
  // A coordinate of a uniform unit vector has a standard deviation of 0.577, its mean over 3600 one of 0.0096.
  EXPECT_LT(length(mean), 0.05F);
  EXPECT_NE(batch.rays[0].direction, batch.rays[1].direction);
  const RayBatch again = generate("shadow", scene, changes);
  const RayBatch other = generate("shadow", scene, changes, 2);
  EXPECT_EQ(batch.rays[7].direction, again.rays[7].direction);
  EXPECT_NE(batch.rays[7].direction, other.rays[7].direction);
}

TEST(Shadow, OneOpenSceneDoesNotShadowItself) {
  Scene scene = floor_and_roof();
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{0, 2, 3}}});
  // Above, below, and in the plane of the square: its triangles are not met from either side.
  scene.lights = {{.name = "above", .position = {1, 1, 3}},
                  {.name = "below", .position = {1, 0, -3}},
                  {.name = "beside", .position = {9, 1, 0}},
                  {.name = "sun below", .position = {1, 2, -0.01F}, .point_at_infinity = true}};
  const Changes changes{{"width", std::int64_t{30}}, {"height", std::int64_t{30}}, {"rays", std::int64_t{4}}};
  const RayBatch batch = generate("shadow", scene, changes);
  ASSERT_EQ(batch.rays.size(), 3600U);
  const std::vector<Hit> hits = test::closest_hits(scene, batch.rays);
  EXPECT_TRUE(std::none_of(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); }));
}

TEST(Shadow, OnlyWhatLiesUnderTheRoofIsInItsShadow) {
  Scene scene = floor_and_roof();
  scene.lights = {{.name = "sun", .position = {0, 0, 1}, .point_at_infinity = true}};
  // From the side, where the camera sees the floor below the roof.
  scene.cameras = {{.name = "side", .eye = {0.3F, 0.3F, 0.3F}, .target = {1.5F, 1.5F, 0}, .up = {0, 0, 1}, .vertical_fov = 60}};
  const RayBatch batch = generate("shadow", scene, {{"width", std::int64_t{64}}, {"height", std::int64_t{48}}});
  const std::vector<Hit> hits = test::closest_hits(scene, batch.rays);
  std::size_t in_shadow = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Vec3 p = batch.rays[i].origin;
    EXPECT_EQ(hits[i].is_hit(), p.x > 1 && p.y > 1 && p.z < 0.5F) << p.x << ' ' << p.y << ' ' << p.z;
    in_shadow += hits[i].is_hit() ? 1U : 0U;
  }
  EXPECT_GT(in_shadow, 20U);
  EXPECT_LT(in_shadow, hits.size());
}

TEST(Reflection, MirrorsTheCameraRayAndMeetsNotItsOwnTriangle) {
  const Scene scene = floor_and_roof();
  const Changes size{{"width", std::int64_t{20}}, {"height", std::int64_t{20}}};
  const RayBatch camera = generate("primary", scene, size);
  const RayBatch batch = generate("reflection", scene, size);
  EXPECT_EQ(batch.query, Query::closest_hit);
  EXPECT_EQ(batch.ray_pixels, camera.ray_pixels);
  ASSERT_EQ(batch.rays.size(), 400U);
  for (std::size_t i = 0; i < batch.rays.size(); ++i) {
    const Vec3 d = camera.rays[i].direction;
    EXPECT_LT(length(batch.rays[i].direction - Vec3{d.x, d.y, -d.z}), 1e-6F);
    EXPECT_EQ(batch.rays[i].tmax, std::numeric_limits<float>::infinity());
  }
  const std::vector<Hit> hits = test::closest_hits(scene, batch.rays);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    // Only the roof is met, from the floor below it.
    if (hits[i].is_hit()) {
      EXPECT_GE(hits[i].triangle, 2U);
      EXPECT_LT(batch.rays[i].origin.z, 0.4F);
    }
  }
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
