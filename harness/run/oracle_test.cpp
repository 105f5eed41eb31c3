#include "harness/run/oracle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "harness/geometry/sampling.h"
#include "tests/support/brute_force.h"

namespace raystudy {
namespace {

using Judgement = ExactOracle::Judgement;

Scene make(std::vector<Vec3> vertices, std::vector<Triangle> triangles) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  finish_scene(scene, "test");
  return scene;
}

/// A closed sphere of radius 1 around `center`, its vertices displaced outwards at random.
Scene bumpy_sphere(Vec3 center, float radius, std::uint32_t rings = 12) {
  const IndexedRandom random(3, 0);
  const std::uint32_t sectors = 2 * rings;
  std::vector<Vec3> vertices{center + Vec3{0, 0, radius}, center - Vec3{0, 0, radius}};
  for (std::uint32_t ring = 1; ring < rings; ++ring) {
    for (std::uint32_t sector = 0; sector < sectors; ++sector) {
      const float theta = std::numbers::pi_v<float> * static_cast<float>(ring) / static_cast<float>(rings);
      const float phi = 2 * std::numbers::pi_v<float> * static_cast<float>(sector) / static_cast<float>(sectors);
      const float r = radius * (1 + 0.1F * random.uniform(vertices.size()));
      vertices.push_back(center + r * Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  }
  const auto at = [&](std::uint32_t ring, std::uint32_t sector) { return 2 + (ring - 1) * sectors + sector % sectors; };
  std::vector<Triangle> triangles;
  for (std::uint32_t s = 0; s < sectors; ++s) {
    triangles.push_back({{0, at(1, s), at(1, s + 1)}});
    triangles.push_back({{1, at(rings - 1, s + 1), at(rings - 1, s)}});
    for (std::uint32_t r = 1; r + 1 < rings; ++r) {
      triangles.push_back({{at(r, s), at(r + 1, s), at(r + 1, s + 1)}});
      triangles.push_back({{at(r, s), at(r + 1, s + 1), at(r, s + 1)}});
    }
  }
  return make(std::move(vertices), std::move(triangles));
}

std::vector<Ray> rays_into(const Scene& scene, std::size_t count) {
  const IndexedRandom random(5, 0);
  std::vector<Ray> rays(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto point = [&](std::uint64_t k) {
      return scene.bounds.lower + scene.bounds.extent() * Vec3{random.uniform(k), random.uniform(k + 1), random.uniform(k + 2)};
    };
    rays[i].origin = point(6 * i);
    rays[i].direction = point(6 * i + 3) - rays[i].origin;
  }
  return rays;
}

TEST(ExactOracle, ClosestHitByHand) {
  // Squares at z = 1 and z = 2; in floats and exactly t = 1/3 of a direction of length 3 is not a float, yet the double nearest
  // to it.
  const Scene scene = make({{-1, -1, 1}, {1, -1, 1}, {0, 2, 1}, {-1, -1, 2}, {1, -1, 2}, {0, 2, 2}}, {{{3, 4, 5}}, {{0, 1, 2}}});
  const ExactOracle oracle(scene);
  Ray ray{{0, 0, 0}, 0, {0, 0, 3}, 10};
  EXPECT_EQ(oracle.closest(ray).triangle, 1U);
  EXPECT_EQ(oracle.closest(ray).t, 1.0 / 3);
  ray.tmin = 0.5F;
  EXPECT_EQ(oracle.closest(ray).triangle, 0U);
  ray.tmax = 0.6F;
  EXPECT_EQ(oracle.closest(ray).triangle, no_hit);
  ray = {{5, 0, 0}, 0, {0, 0, 1}, 10};
  EXPECT_EQ(oracle.closest(ray).triangle, no_hit);
}

TEST(ExactOracle, ToleranceByHand) {
  const Scene scene = make({{0, 0, 0}, {1, 0, 0}, {0, 4, 0}}, {{{0, 1, 2}}});
  const ExactOracle oracle(scene);
  // The farthest coordinate from (1, 1, -8) is z: 8.
  EXPECT_DOUBLE_EQ(oracle.tolerance({{1, 1, -8}, 0, {0, 0, 1}, 1}, 0), 32.0 / (1 << 24) * 8);
}

class PlantedHits : public testing::Test {
 protected:
  PlantedHits()
      : scene(bumpy_sphere({1, 2, 3}, 2)),
        rays(rays_into(scene, 2000)),
        reference(test::closest_hits(scene, rays)),
        hits(reference) {
    while (!reference[index].is_hit()) ++index;
  }
  OracleReport check(Query query = Query::closest_hit) { return check_hits(scene, rays, hits, reference, query); }

  Scene scene;
  std::vector<Ray> rays;
  std::vector<Hit> reference;
  std::vector<Hit> hits;
  std::size_t index = 100;
};

TEST_F(PlantedHits, NoneIsFound) {
  const OracleReport report = check();
  EXPECT_TRUE(report.ok()) << report.text(rays, Query::closest_hit);
  EXPECT_EQ(report.rays, 2000U);
  EXPECT_EQ(report.disputed, 0U);
  EXPECT_GE(report.sampled, 64U);
  EXPECT_EQ(report.text(rays, Query::closest_hit), "");
}

TEST_F(PlantedHits, LostHit) {
  hits[index] = {};
  EXPECT_EQ(check().wrong, 1U);
  EXPECT_EQ(check(Query::any_hit).wrong, 1U);
}

TEST_F(PlantedHits, HitThatIsNotThere) {
  rays[index].tmax = 0.5F * hits[index].t;
  reference[index] = {};
  EXPECT_EQ(check().wrong, 1U);
  EXPECT_EQ(check(Query::any_hit).wrong, 1U);
}

TEST_F(PlantedHits, AnotherTriangle) {
  hits[index].triangle = (hits[index].triangle + 7) % static_cast<std::uint32_t>(scene.triangles.size());
  reference = hits;  // even where the reference makes the same mistake, a full sample finds it
  EXPECT_EQ(Oracle(scene).check(rays, hits, reference, Query::closest_hit, true, rays.size()).wrong, 1U);
}

TEST_F(PlantedHits, IndexOutOfRange) {
  hits[index].triangle = 100000;
  reference[index] = {};
  EXPECT_EQ(check().wrong, 1U);
}

TEST_F(PlantedHits, AreFoundByAnOracleThatHasSeenRightOnes) {
  Oracle oracle(scene);
  const auto wrong = [&](Query query) { return oracle.check(rays, hits, reference, query, true, rays.size()).wrong; };
  EXPECT_EQ(wrong(Query::closest_hit), 0U);
  EXPECT_EQ(wrong(Query::any_hit), 0U);
  const Hit right = hits[index];
  hits[index].u += 0.1F;
  EXPECT_EQ(wrong(Query::closest_hit), 1U);
  hits[index] = {};
  EXPECT_EQ(wrong(Query::closest_hit), 1U);
  EXPECT_EQ(wrong(Query::any_hit), 1U);
  hits[index].triangle = 100000;
  EXPECT_EQ(wrong(Query::any_hit), 1U);
  hits[index] = right;
  rays[index].tmax = 0.5F * right.t;
  EXPECT_EQ(wrong(Query::closest_hit), 1U);
  EXPECT_EQ(wrong(Query::any_hit), 1U);
}

TEST_F(PlantedHits, WrongDistance) {
  hits[index].t *= 1.0001F;
  EXPECT_EQ(check().wrong, 1U);
}

TEST_F(PlantedHits, WeightsSwapped) {
  std::swap(hits[index].u, hits[index].v);
  reference = hits;
  EXPECT_EQ(Oracle(scene).check(rays, hits, reference, Query::closest_hit, true, rays.size()).wrong, 1U);
}

TEST_F(PlantedHits, FartherHitThroughTheSphere) {
  // A ray from outside: the far side instead of the near one.
  Ray ray{{-5, 2.1F, 3.1F}, 0, {1, 0, 0}, 100};
  const Hit near = test::closest_hits(scene, {&ray, 1})[0];
  ray.tmin = near.t + 0.1F;
  const Hit far = test::closest_hits(scene, {&ray, 1})[0];
  ray.tmin = 0;
  ASSERT_TRUE(far.is_hit());
  ASSERT_NE(far.triangle, near.triangle);
  EXPECT_FALSE(check_hits(scene, {&ray, 1}, {&far, 1}, {&near, 1}, Query::closest_hit).ok());
  EXPECT_TRUE(check_hits(scene, {&ray, 1}, {&near, 1}, {&far, 1}, Query::closest_hit).ok())
      << "the reference is wrong, not the hit";
}

TEST_F(PlantedHits, AllLostStopsEarly) {
  std::fill(hits.begin(), hits.end(), Hit{});
  EXPECT_EQ(check().wrong, 8U);
}

TEST(Oracle, TextSaysWhichRayAndWhatWasFound) {
  const Scene scene = make({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{{0, 1, 2}}});
  const Ray ray{{0.25F, 0.25F, 0}, 0, {0, 0, 0.5F}, 10};
  const Hit lost;
  const Hit reference{2, 0, 0.25F, 0.25F};
  const OracleReport report = check_hits(scene, {&ray, 1}, {&lost, 1}, {&reference, 1}, Query::closest_hit);
  EXPECT_EQ(
      report.text({&ray, 1}, Query::closest_hit),
      "wrong hits: 1 of 1 closest-hit rays\n"
      "  ray 0 from (0.25, 0.25, 0) along (0, 0, 0.5), t in [0, 10]: found nothing, the reference triangle 0 at t = 2 (u = 0.25, "
      "v = 0.25), exact arithmetic triangle 0 at t = 2");
}

TEST(Oracle, MissAtAnOpenEdgeIsRightAndOneInsideIsWrong) {
  const Scene scene = make({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{{0, 1, 2}}});
  const ExactOracle oracle(scene);
  EXPECT_TRUE(oracle.judge({{0.5F, 0x1p-24F, 0}, 0, {0, 0, 1}, 10}, {}, Query::closest_hit).judgement == Judgement::right);
  EXPECT_FALSE(oracle.judge({{0.5F, 0x1p-17F, 0}, 0, {0, 0, 1}, 10}, {}, Query::closest_hit).judgement == Judgement::right);
  EXPECT_FALSE(oracle.judge({{0.5F, 0x1p-17F, 0}, 0, {0, 0, 1}, 10}, {}, Query::any_hit).judgement == Judgement::right);
  // The same for a hit that is not quite there.
  const Hit hit{1, 0, 0.5F, 0};
  EXPECT_TRUE(oracle.judge({{0.5F, -0x1p-24F, 0}, 0, {0, 0, 1}, 10}, hit, Query::closest_hit).judgement == Judgement::right);
  EXPECT_FALSE(oracle.judge({{0.5F, -0x1p-17F, 0}, 0, {0, 0, 1}, 10}, hit, Query::closest_hit).judgement == Judgement::right);
}

TEST(Oracle, MissAtASharedEdgeIsWrongAtASilhouetteRight) {
  // Two triangles that share the edge x = 0: flat they cover both its sides; folded they both lie at x > 0.
  const Ray ray{{0, 0.5F, 0}, 0, {0, 0, 1}, 10};
  const Scene flat = make({{0, 0, 1}, {0, 1, 1}, {1, 0.5F, 1}, {-1, 0.5F, 1}}, {{{0, 1, 2}}, {{0, 1, 3}}});
  EXPECT_FALSE(ExactOracle(flat).judge(ray, {}, Query::closest_hit).judgement == Judgement::right);
  const Scene folded = make({{0, 0, 1}, {0, 1, 1}, {1, 0.5F, 1}, {1, 0.5F, 2}}, {{{0, 1, 2}}, {{0, 1, 3}}});
  EXPECT_TRUE(ExactOracle(folded).judge(ray, {}, Query::closest_hit).judgement == Judgement::right);
}

TEST(Oracle, LeaksAreToldFromOtherWrongHits) {
  const Scene scene = make({{0, 0, 1}, {0, 1, 1}, {1, 0.5F, 1}, {-1, 0.5F, 1}, {-9, -9, 2}, {9, -9, 2}, {0, 9, 2}},
                           {{{0, 1, 2}}, {{0, 1, 3}}, {{4, 5, 6}}});
  const ExactOracle oracle(scene);
  const Ray on_edge{{0, 0.5F, 0}, 0, {0, 0, 1}, 10};
  const Ray inside{{0.25F, 0.5F, 0}, 0, {0, 0, 1}, 10};
  ASSERT_TRUE(test::closest_hits(scene, {&inside, 1})[0].triangle == 0U);
  Ray past = on_edge;
  past.tmin = 1.5F;
  const Hit behind = test::closest_hits(scene, {&past, 1})[0];
  past.origin = inside.origin;
  const Hit behind_inside = test::closest_hits(scene, {&past, 1})[0];
  EXPECT_EQ(oracle.judge(on_edge, behind, Query::closest_hit).judgement, Judgement::leak);
  EXPECT_EQ(oracle.judge(inside, behind_inside, Query::closest_hit).judgement, Judgement::wrong);
  EXPECT_EQ(oracle.judge(on_edge, {}, Query::closest_hit).judgement, Judgement::wrong) << "the wall behind is not to be missed";
  const Hit edge_hit = test::closest_hits(scene, {&on_edge, 1})[0];
  EXPECT_EQ(check_hits(scene, {&on_edge, 1}, {&behind, 1}, {&edge_hit, 1}, Query::closest_hit, false).leaks, 1U);
  EXPECT_TRUE(check_hits(scene, {&on_edge, 1}, {&behind, 1}, {&edge_hit, 1}, Query::closest_hit, false).ok());
  EXPECT_EQ(check_hits(scene, {&on_edge, 1}, {&behind, 1}, {&edge_hit, 1}, Query::closest_hit, true).wrong, 1U);
}

TEST(Oracle, EitherOfTwoTrianglesAtOneDistanceIsRight) {
  const Scene scene = make({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{{0, 1, 2}}, {{0, 1, 2}}});
  const Ray ray{{0.25F, 0.25F, 0}, 0, {0, 0, 1}, 10};
  for (std::uint32_t t = 0; t < 2; ++t) {
    const Hit hit{1, t, 0.25F, 0.25F};
    const Hit other{1, 1 - t, 0.25F, 0.25F};
    EXPECT_EQ(check_hits(scene, {&ray, 1}, {&hit, 1}, {&other, 1}, Query::closest_hit).disputed, 0U);
    EXPECT_TRUE(check_hits(scene, {&ray, 1}, {&hit, 1}, {&other, 1}, Query::closest_hit).ok());
  }
}

TEST(Oracle, RaysThatMayHitNothing) {
  const Scene scene = make({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{{0, 1, 2}}});
  const ExactOracle oracle(scene);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Ray& ray : {Ray{{0.2F, 0.2F, 0}, 0, {0, 0, 0}, 10}, Ray{{0.2F, 0.2F, 0}, 0, {0, nan, 1}, 10},
                         Ray{{0.2F, 0.2F, 0}, 2, {0, 0, 1}, 1}}) {
    EXPECT_TRUE(oracle.judge(ray, {}, Query::closest_hit).judgement == Judgement::right);
    EXPECT_FALSE(oracle.judge(ray, {1, 0, 0.2F, 0.2F}, Query::closest_hit).judgement == Judgement::right);
  }
}

TEST(Oracle, RobustEmbreeAgreesWithBruteForce) {
  const Scene scene = bumpy_sphere({1, 2, 3}, 2);
  const std::vector<Ray> rays = rays_into(scene, 5000);
  std::vector<Hit> reference(rays.size());
  ReferenceTracer(scene, 1).trace(rays, reference, Query::closest_hit);
  const std::vector<Hit> hits = test::closest_hits(scene, rays);
  const OracleReport report = check_hits(scene, rays, hits, reference, Query::closest_hit);
  EXPECT_TRUE(report.ok()) << report.text(rays, Query::closest_hit);
  EXPECT_LT(report.disputed, 5U);
}

}  // namespace
}  // namespace raystudy
