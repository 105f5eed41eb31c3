// Hits of streams against those of testing every triangle, and the order of rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "harness/accel/wide_bvh.h"
#include "harness/method/registry.h"
#include "methods/streams/ray_sorter.h"
#include "methods/wide/wide_ray.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/trees.h"

namespace raystudy::streams {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

std::unique_ptr<Accel> encode(const Bvh2& bvh, const Scene& scene, const std::string& encoder, Changes changes = {}) {
  const Registry& registry = Registry::instance();
  return registry.create<Encoder>(registry.ref(Role::encoder, encoder, std::move(changes)))->encode(bvh, scene, {});
}

std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene& scene, Changes changes, int threads = 1) {
  const Registry& registry = Registry::instance();
  return registry.create<Tracer>(registry.ref(Role::tracer, "stream", std::move(changes)))->prepare(accel, scene, threads, false);
}

std::vector<Hit> traced(TraceSession& session, std::span<const Ray> rays, Query query) {
  std::vector<Hit> hits(rays.size(), Hit{1, 1, 1, 1});
  session.trace(rays, hits, query);
  return hits;
}

/// Rays from a few points into a cone each, as many from each point: what streams are for.
std::vector<Ray> bundles() {
  std::vector<Ray> rays = test::random_rays(2000, 3);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray& first = rays[i - i % 50];
    rays[i].origin = first.origin;
    rays[i].direction = first.direction + 0.3F * rays[i].direction;
  }
  return rays;
}

/// All ways a stream tracer may be set, but for the size of a block.
std::vector<Changes> settings() {
  std::vector<Changes> all;
  for (const char* size : {"32", "64"}) {
    for (const char* simd : {"auto", "avx2"}) {
      for (const std::int64_t bits : {0, 2}) {
        all.push_back(
            {{"size", std::string(size)}, {"simd", std::string(simd)}, {"origin_bits", bits}, {"direction_bits", bits}});
      }
    }
  }
  return all;
}

std::string text(const Changes& changes) {
  std::string all;
  for (const auto& [key, value] : changes) {
    if (const auto* s = std::get_if<std::string>(&value)) all += key + "=" + *s + " ";
    if (const auto* i = std::get_if<std::int64_t>(&value)) all += key + "=" + std::to_string(*i) + " ";
  }
  return all;
}

void expect_hits(const Scene& scene, const Accel& accel, std::span<const Ray> rays) {
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const Hit& h) { return h.is_hit(); }), 0);
  for (const Changes& changes : settings()) {
    SCOPED_TRACE(text(changes));
    const auto session = prepare(accel, scene, changes);
    test::expect_same(expected, traced(*session, rays, Query::closest_hit));
    const std::vector<Hit> any = traced(*session, rays, Query::any_hit);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(any[i].is_hit(), expected[i].is_hit()) << "ray " << i;
  }
}

class Streams : public testing::TestWithParam<std::string> {};

TEST_P(Streams, HitsAreThoseOfTestingEveryTriangle) {
  for (const int triangles : {1, 7, 400}) {
    const Scene scene = test::soup(triangles, 0.3F, 1);
    for (const std::string boxes : {"float", "8-bit"}) {
      for (const std::uint32_t leaf_triangles : {1U, 5U, 60U}) {
        const auto accel = encode(test::random_tree(scene, 4, leaf_triangles), scene, GetParam(),
                                  {{"boxes", boxes}, {"max_leaf_triangles", std::int64_t{12}}});
        expect_hits(scene, *accel, test::random_rays(2500, 2));
        if (triangles == 400) expect_hits(scene, *accel, bundles());
      }
    }
  }
}

TEST_P(Streams, MixedLimitsAndInvalidRays) {
  const Scene scene = test::soup(200, 0.4F, 5);
  const auto accel = encode(test::random_tree(scene, 2, 3), scene, GetParam());
  std::vector<Ray> rays = bundles();
  const std::vector<Ray> invalid = test::invalid_rays();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 3 == 0) rays[i].tmax = 0.2F + 0.1F * static_cast<float>(i % 7);
    if (i % 4 == 0) rays[i].tmin = 0.1F * static_cast<float>(i % 5);
    if (i % 11 == 0) rays[i] = invalid[i / 11 % invalid.size()];
  }
  expect_hits(scene, *accel, rays);
}

TEST_P(Streams, DirectionsAndCoordinatesOfExtremeSize) {
  const Scene scene = test::soup(100, 0.5F, 6);
  std::vector<Ray> rays = bundles();
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (i % 3 == 0) rays[i].direction = rays[i].direction * std::ldexp(1.0F, static_cast<int>(i % 120) - 60);
    if (i % 97 == 0) rays[i].origin = rays[i].origin * 1e25F;
    if (i % 89 == 0) rays[i].direction.x = 1e-38F;
  }
  expect_hits(scene, *encode(test::random_tree(scene, 2, 3), scene, GetParam()), rays);
}

TEST_P(Streams, OddCountsAndBlocks) {
  const Scene scene = test::soup(100, 0.5F, 7);
  const auto accel = encode(test::random_tree(scene, 2, 3), scene, GetParam());
  const std::vector<Ray> rays = bundles();
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  for (const std::int64_t block : {1, 64, 1000, 1 << 20}) {
    const auto session = prepare(*accel, scene, {{"block", block}});
    for (const std::size_t count : {0, 1, 2, 15, 17, 63, 65, 1000, 1999}) {
      std::vector<Hit> hits(count + 1, Hit{1, 1, 1, 1});
      session->trace({rays.data(), count}, {hits.data(), count}, Query::closest_hit);
      test::expect_same({expected.data(), count}, {hits.data(), count});
      EXPECT_EQ(hits[count].triangle, 1U) << "written past the end";
    }
  }
}

TEST_P(Streams, EqualDistancesGoToTheLowestTriangle) {
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

TEST_P(Streams, EmptyTreeHitsNothing) {
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

TEST_P(Streams, TheSameForAnyThreads) {
  const Scene scene = test::soup(300, 0.3F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 5), scene, GetParam());
  const std::vector<Ray> rays = test::random_rays(5000, 9);
  const Changes changes{{"block", std::int64_t{512}}};
  const auto one = prepare(*accel, scene, changes, 1);
  const auto two = prepare(*accel, scene, changes, 2);
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    test::expect_same(traced(*one, rays, query), traced(*two, rays, query));
  }
}

TEST_P(Streams, CoherentRaysAsPackets) {
  const Scene scene = test::soup(300, 0.3F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 5), scene, GetParam());
  const std::vector<Ray> rays = bundles();
  const auto session = prepare(*accel, scene, {{"coherent", std::string("on")}});
  test::expect_same(test::closest_hits(scene, rays), traced(*session, rays, Query::closest_hit));
}

INSTANTIATE_TEST_SUITE_P(Streams, Streams, testing::Values("bvh4", "bvh8", "bvh16"));

TEST(StreamCounts, ByHand) {
  // Two triangles side by side across x. One ray hits the left triangle, one passes between them, one is right of both.
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
  // Each goes into the root, and only the first meets a box below.
  EXPECT_EQ(steps, (std::vector<std::uint32_t>{2, 1, 1}));
  EXPECT_EQ(counts.inner_nodes, 3U);
  EXPECT_EQ(counts.leaves, 1U);
  EXPECT_EQ(counts.box_tests, 3U * 8U);
  EXPECT_EQ(counts.triangle_tests, 1U);
}

TEST(StreamCounts, StepsAddUpWhateverTheOrder) {
  const Scene scene = test::soup(300, 0.3F, 8);
  const auto accel = encode(test::random_tree(scene, 3, 2), scene, "bvh8");
  const std::vector<Ray> rays = test::random_rays(1000, 9);
  for (const Changes& changes : settings()) {
    std::vector<std::uint32_t> steps(rays.size());
    const auto session = prepare(*accel, scene, changes);
    const TraceCounts counts = session->count(rays, Query::closest_hit, steps);
    EXPECT_EQ(std::accumulate(steps.begin(), steps.end(), std::uint64_t{0}), counts.traversal_steps()) << text(changes);
    EXPECT_GT(counts.triangle_tests, 0U);
    // What a ray meets does not depend on its company: alone in its stream it makes the same steps.
    std::vector<std::uint32_t> alone(1);
    session->count({rays.data() + 17, 1}, Query::closest_hit, alone);
    EXPECT_EQ(steps[17], alone[0]) << text(changes);
  }
}

std::vector<std::uint32_t> sorted(std::span<const Ray> rays, const SortKey& key) {
  RaySorter sorter({{0, 0, 0}, {1, 1, 1}}, key);
  sorter.sort(rays);
  return {sorter.order().begin(), sorter.order().end()};
}

TEST(RaySorter, SectorsStandInRowAndRaysKeepTheirOrder) {
  const std::vector<Ray> rays = test::random_rays(1000, 4);
  RaySorter sorter({{0, 0, 0}, {1, 1, 1}}, {.origin_bits = 0, .direction_bits = 0});
  sorter.sort(rays);
  ASSERT_EQ(sorter.order().size(), rays.size());
  EXPECT_EQ(sorter.begin(0), 0U);
  EXPECT_EQ(sorter.begin(Sector::count), rays.size());
  for (unsigned s = 0; s < Sector::count; ++s) {
    const Sector sector = Sector::at(s);
    for (std::size_t i = sorter.begin(s); i < sorter.begin(s + 1); ++i) {
      const std::uint32_t ray = sorter.order()[i];
      for (int a = 0; a < 3; ++a) {
        EXPECT_EQ(std::signbit(rays[ray].direction[a]), ((sector.octant >> static_cast<unsigned>(a)) & 1U) != 0);
      }
      if (i > sorter.begin(s)) {
        EXPECT_LT(sorter.order()[i - 1], ray);
      }
    }
  }
}

/// As the watertight test has it, ties included: streams have one axis for all their rays.
TEST(RaySorter, AxesAreThoseOfTheTriangleTest) {
  std::vector<Ray> rays = test::random_rays(2000, 7);
  for (const Vec3 d :
       {Vec3{1, 1, 1}, Vec3{1, 1, 0}, Vec3{0, 1, -1}, Vec3{-1, 0, 1}, Vec3{0, 0, -1}, Vec3{0, -2, 0}, Vec3{3, 0, 0}}) {
    rays.push_back({{0.5F, 0.25F, 2}, 0, d});
  }
  const wide::SlabScene scene(Box({-1, -1, -1}, {1, 1, 1}));
  for (const Ray& ray : rays) {
    ASSERT_EQ(Sector::of(ray).along, static_cast<unsigned>(wide::WideRay(ray, scene).along));
    ASSERT_EQ(Sector::at(Sector::of(ray).index()).octant, Sector::of(ray).octant);
  }
}

TEST(RaySorter, ByDirectionAndByOrigin) {
  std::vector<Ray> rays(4);
  // All along z; by x and y, rays 1 and 3 go straighter.
  rays[0] = {{0.9F, 0.9F, 0.9F}, 0, {0.9F, 0.9F, 1}};
  rays[1] = {{0.1F, 0.1F, 0.1F}, 0, {0.1F, 0.1F, 1}};
  rays[2] = {{0.1F, 0.1F, 0.1F}, 0, {0.9F, 0.9F, 1}};
  rays[3] = {{0.9F, 0.9F, 0.9F}, 0, {0.1F, 0.1F, 1}};
  EXPECT_EQ(sorted(rays, {.origin_bits = 0, .direction_bits = 1}), (std::vector<std::uint32_t>{1, 3, 0, 2}));
  EXPECT_EQ(sorted(rays, {.origin_bits = 2, .direction_bits = 0}), (std::vector<std::uint32_t>{1, 2, 0, 3}));
  EXPECT_EQ(sorted(rays, {.origin_bits = 2, .direction_bits = 1}), (std::vector<std::uint32_t>{1, 2, 3, 0}));
  EXPECT_EQ(sorted(rays, {.origin_bits = 6, .direction_bits = 4}), (std::vector<std::uint32_t>{1, 2, 3, 0}));
}

TEST(RaySorter, TakesRaysThatAreNotFinite) {
  const std::vector<Ray> rays = test::invalid_rays();
  std::vector<std::uint32_t> order = sorted(rays, {.origin_bits = 6, .direction_bits = 4});
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace raystudy::streams
