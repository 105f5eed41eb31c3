#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "harness/accel/wide_bvh.h"
#include "harness/method/registry.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

std::unique_ptr<Accel> encode(const Bvh2& bvh, const Scene& scene, const std::string& encoder, Changes changes = {}) {
  const Registry& registry = Registry::instance();
  return registry.create<Encoder>(registry.ref(Role::encoder, encoder, std::move(changes)))->encode(bvh, scene, {});
}

std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene& scene, Changes changes, int threads = 1) {
  const Registry& registry = Registry::instance();
  const auto tracer = registry.create<Tracer>(registry.ref(Role::tracer, "packet", std::move(changes)));
  return tracer->prepare(accel, scene, threads, true);
}

std::vector<Hit> traced(TraceSession& session, std::span<const Ray> rays, Query query) {
  std::vector<Hit> hits(rays.size(), Hit{1, 1, 1, 1});
  session.trace(rays, hits, query);
  return hits;
}

void expect_same_occlusion(std::span<const Hit> closest, std::span<const Hit> any) {
  for (std::size_t i = 0; i < closest.size(); ++i) ASSERT_EQ(closest[i].is_hit(), any[i].is_hit()) << "ray " << i;
}

/// A pencil of rays from one point, row by row through a square, 64 to a row, towards `target`.
std::vector<Ray> pencil(Vec3 eye, Vec3 target, float half_width) {
  const Vec3 forward = normalized(target - eye);
  const Vec3 side = normalized(cross(forward, std::fabs(forward.x) < 0.5F ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 up = cross(side, forward);
  std::vector<Ray> rays;
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 64; ++x) {
      Ray ray;
      ray.origin = eye;
      ray.direction =
          forward + side * (half_width * (static_cast<float>(x) / 32 - 1)) + up * (half_width * (static_cast<float>(y) / 8 - 1));
      rays.push_back(ray);
    }
  }
  return rays;
}

/// All ways a packet tracer may be set.
std::vector<Changes> settings() {
  std::vector<Changes> all;
  for (const char* size : {"4", "16", "64", "256"}) {
    for (const char* culling : {"interval", "frustum", "none"}) {
      for (const bool first_active : {true, false}) {
        for (const char* simd : {"auto", "avx2"}) {
          all.push_back({{"size", std::string(size)},
                         {"culling", std::string(culling)},
                         {"first_active", first_active},
                         {"simd", std::string(simd)}});
        }
      }
    }
  }
  return all;
}

std::string text(const Changes& changes) {
  std::string all;
  for (const auto& [key, value] : changes) {
    if (const auto* s = std::get_if<std::string>(&value)) all += key + "=" + *s + " ";
    if (const auto* b = std::get_if<bool>(&value)) all += key + (*b ? "=true " : "=false ");
  }
  return all;
}

class Packets : public testing::TestWithParam<std::string> {};

void expect_hits(const Scene& scene, const Accel& accel, std::span<const Ray> rays) {
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const Hit& h) { return h.is_hit(); }), 0);
  for (const Changes& changes : settings()) {
    SCOPED_TRACE(text(changes));
    const auto session = prepare(accel, scene, changes);
    test::expect_same(expected, traced(*session, rays, Query::closest_hit));
    expect_same_occlusion(expected, traced(*session, rays, Query::any_hit));
  }
}

TEST_P(Packets, HitsOfRaysAllOverAreThoseOfEveryTriangle) {
  const Scene scene = test::soup(300, 0.3F, 1);
  for (const std::string boxes : {"float", "8-bit"}) {
    const auto accel = encode(test::random_tree(scene, 3, 5), scene, GetParam(), {{"boxes", boxes}});
    expect_hits(scene, *accel, test::random_rays(1501, 2));
  }
}

TEST_P(Packets, HitsOfCoherentRaysAreThoseOfEveryTriangle) {
  const Scene scene = test::soup(400, 0.2F, 4);
  for (const std::string boxes : {"float", "8-bit"}) {
    const auto accel = encode(test::random_tree(scene, 1, 2), scene, GetParam(), {{"boxes", boxes}});
    // Within one octant, across several, about an axis, and from inside.
    expect_hits(scene, *accel, pencil({-3, -2.9F, -2.8F}, {0, 0, 0}, 0.1F));
    expect_hits(scene, *accel, pencil({2, 0, -0.1F}, {0, 0, 0}, 0.5F));
    expect_hits(scene, *accel, pencil({0, 0, 3}, {0, 0, 0}, 0.3F));
    expect_hits(scene, *accel, pencil({0.1F, 0.2F, 0}, {0, 1, 0}, 3));
  }
}

TEST_P(Packets, MixedLimitsAndInvalidRays) {
  const Scene scene = test::soup(200, 0.4F, 5);
  const auto accel = encode(test::random_tree(scene, 2, 3), scene, GetParam());
  std::vector<Ray> rays = pencil({-3, -2.9F, -2.8F}, {0, 0, 0}, 0.1F);
  const std::vector<Ray> invalid = test::invalid_rays();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 3 == 0) rays[i].tmax = 2 + static_cast<float>(i % 7);
    if (i % 4 == 0) rays[i].tmin = 1 + static_cast<float>(i % 5);
    if (i % 11 == 0) rays[i] = invalid[i / 11 % invalid.size()];
  }
  expect_hits(scene, *accel, rays);
}

TEST_P(Packets, DirectionsAndCoordinatesOfExtremeSize) {
  Scene scene = test::soup(100, 0.5F, 6);
  std::vector<Ray> rays = pencil({-3, -2.9F, -2.8F}, {0, 0, 0}, 0.1F);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 3 == 0) rays[i].direction = rays[i].direction * std::ldexp(1.0F, static_cast<int>(i % 120) - 60);
    if (i % 97 == 0) rays[i].origin = rays[i].origin * 1e25F;
    if (i % 89 == 0) rays[i].direction.x = 1e-38F;
  }
  expect_hits(scene, *encode(test::random_tree(scene, 2, 3), scene, GetParam()), rays);
}

TEST_P(Packets, OddCounts) {
  const Scene scene = test::soup(100, 0.5F, 7);
  const auto accel = encode(test::random_tree(scene, 2, 3), scene, GetParam());
  const std::vector<Ray> rays = pencil({-3, -2.9F, -2.8F}, {0, 0, 0}, 0.1F);
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  for (const char* size : {"4", "16", "64", "256"}) {
    const auto session = prepare(*accel, scene, {{"size", std::string(size)}});
    for (const std::size_t count : {0, 1, 2, 3, 5, 15, 17, 63, 65, 255, 257, 1000}) {
      std::vector<Hit> hits(count + 1, Hit{1, 1, 1, 1});
      session->trace({rays.data(), count}, {hits.data(), count}, Query::closest_hit);
      test::expect_same({expected.data(), count}, {hits.data(), count});
      EXPECT_EQ(hits[count].triangle, 1U) << "written past the end";
    }
  }
}

TEST_P(Packets, EqualDistancesGoToTheLowestTriangle) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
  scene.triangles = SharedArray<Triangle>(std::vector<Triangle>(40, Triangle{{0, 1, 2}}));
  finish_scene(scene, "forty times one triangle");
  const std::vector<Ray> rays(70, Ray{{0, 0, -1}, 0, {0, 0, 1}, std::numeric_limits<float>::infinity()});
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const auto accel = encode(test::random_tree(scene, seed, 2), scene, GetParam());
    for (const Hit& hit : traced(*prepare(*accel, scene, {}), rays, Query::closest_hit)) {
      EXPECT_EQ(hit.triangle, 0U);
      EXPECT_EQ(hit.t, 1.0F);
    }
  }
}

TEST_P(Packets, EmptyTreeHitsNothing) {
  const Scene scene;
  const auto accel = encode({}, scene, GetParam());
  const std::vector<Ray> rays = test::random_rays(100, 1);
  const auto session = prepare(*accel, scene, {});
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    for (const Hit& hit : traced(*session, rays, query)) EXPECT_FALSE(hit.is_hit());
    std::vector<std::uint32_t> steps(rays.size(), 7);
    EXPECT_EQ(session->count(rays, query, steps).traversal_steps(), 0U);
    EXPECT_EQ(std::count(steps.begin(), steps.end(), 0U), 100);
  }
}

TEST_P(Packets, TheSameForAnyThreads) {
  const Scene scene = test::soup(300, 0.3F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 5), scene, GetParam());
  const std::vector<Ray> rays = test::random_rays(5000, 9);
  const auto one = prepare(*accel, scene, {}, 1);
  const auto two = prepare(*accel, scene, {}, 2);
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    test::expect_same(traced(*one, rays, query), traced(*two, rays, query));
  }
}

INSTANTIATE_TEST_SUITE_P(Packets, Packets, testing::Values("bvh4", "bvh8", "bvh16"));

TEST(PacketCounts, ByHand) {
  // Two triangles side by side across x. Of the three rays of one packet, one hits the left triangle, one passes between them,
  // one is right of both.
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{-2, -1, 0}, {-1, -1, 0}, {-1.5F, 1, 0}, {1, -1, 0}, {2, -1, 0}, {1.5F, 1, 0}});
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{3, 4, 5}}});
  finish_scene(scene, "two triangles");
  const auto accel = encode(test::random_tree(scene, 1), scene, "bvh8", {{"max_leaf_triangles", std::int64_t{1}}});
  std::vector<Ray> rays(3);
  rays[0].origin = {-1.5F, 0, -1};
  rays[1].origin = {0, 0, -1};
  rays[2].origin = {5, 0, -1};
  for (Ray& ray : rays) ray.direction = {0, 0, 1};
  std::vector<std::uint32_t> steps(3);
  const TraceCounts counts = prepare(*accel, scene, {})->count(rays, Query::closest_hit, steps);
  // All go into the root together; the packet's interval of x covers both boxes, and all rays are tested against each.
  EXPECT_EQ(steps, (std::vector<std::uint32_t>{2, 1, 1}));
  EXPECT_EQ(counts.inner_nodes, 3U);
  EXPECT_EQ(counts.leaves, 1U);
  EXPECT_EQ(counts.box_tests, 8U + 3U + 3U);
  EXPECT_EQ(counts.triangle_tests, 1U);
}

TEST(PacketCounts, StepsAddUp) {
  const Scene scene = test::soup(300, 0.3F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 2), scene, "bvh8");
  const std::vector<Ray> rays = test::random_rays(1000, 9);
  for (const Changes& changes : settings()) {
    std::vector<std::uint32_t> steps(rays.size());
    const TraceCounts counts = prepare(*accel, scene, changes)->count(rays, Query::closest_hit, steps);
    EXPECT_EQ(std::accumulate(steps.begin(), steps.end(), std::uint64_t{0}), counts.traversal_steps()) << text(changes);
    EXPECT_GT(counts.triangle_tests, 0U);
  }
}

TEST(PacketCounts, CullingSparesTestsOfRays) {
  const Scene scene = test::soup(2000, 0.05F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 1), scene, "bvh8");
  const std::vector<Ray> rays = pencil({-3, -2.9F, -2.8F}, {0, 0, 0}, 0.02F);
  const auto box_tests = [&](const Changes& changes) {
    return prepare(*accel, scene, changes)->count(rays, Query::closest_hit, {}).box_tests;
  };
  const Changes none{{"culling", std::string("none")}};
  EXPECT_LT(box_tests({}), box_tests(none));
  EXPECT_LT(box_tests({{"culling", std::string("frustum")}}), box_tests(none));
  EXPECT_LT(box_tests({}), box_tests({{"first_active", false}}));
}

}  // namespace
}  // namespace raystudy
