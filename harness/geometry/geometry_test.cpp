// The ray-box and ray-triangle tests: by hand, at their edges, and against each other.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "harness/geometry/sampling.h"
#include "harness/geometry/slab.h"
#include "harness/geometry/watertight.h"

namespace raystudy {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float denormal = std::numeric_limits<float>::denorm_min();
constexpr Box unit_box{{0, 0, 0}, {1, 1, 1}};

bool meets(const Ray& ray, const Box& box, const Box& bounds) {
  const SlabRay slabs(ray, bounds);
  return test_boxes(slabs, SlabPair(box, box), slabs.limits(ray.tmin, ray.tmax)).mask != 0;
}
bool meets(const Ray& ray, const Box& box) { return meets(ray, box, box); }

TEST(Slab, EntersWhereTheBoxBegins) {
  const Ray ray{{-2, 0.5F, 0.5F}, 0, {2, 0, 0}, 10};
  const SlabRay slabs(ray, {{0, 0, 0}, {5, 1, 1}});
  const SlabPair pair({{0, 0, 0}, {1, 1, 1}}, {{4, 0, 0}, {5, 1, 1}});
  const SlabHit hit = test_boxes(slabs, pair, slabs.limits(ray.tmin, ray.tmax));
  EXPECT_EQ(hit.mask, 3U);
  EXPECT_NEAR(hit.near[0], 1, 1e-5F);
  EXPECT_LE(hit.near[0], 1);
  EXPECT_NEAR(hit.near[1], 3, 1e-5F);
  EXPECT_LE(hit.near[1], 3);
  EXPECT_EQ(test_boxes(slabs, pair, slabs.limits(0, 2)).mask, 1U);
  EXPECT_EQ(test_boxes(slabs, pair, slabs.limits(2, 10)).mask, 2U);
  EXPECT_EQ(test_boxes(slabs, pair, slabs.limits(1.75F, 2.5F)).mask, 0U);
}

TEST(Slab, AxisParallelRaysOfEitherZero) {
  for (const float zero : {0.0F, -0.0F}) {
    EXPECT_TRUE(meets({{0.5F, 0.5F, -1}, 0, {zero, zero, 1}, infinity}, unit_box));
    EXPECT_TRUE(meets({{0.5F, 0.5F, 2}, 0, {zero, zero, -1}, infinity}, unit_box));
    EXPECT_FALSE(meets({{1.5F, 0.5F, -1}, 0, {zero, zero, 1}, infinity}, unit_box));
    EXPECT_FALSE(meets({{0.5F, -0.5F, -1}, 0, {zero, zero, 1}, infinity}, unit_box));
    EXPECT_FALSE(meets({{0.5F, 0.5F, 2}, 0, {zero, zero, 1}, infinity}, unit_box)) << "behind the origin";
    // In a face, along an edge, through a corner.
    for (const float x : {0.0F, 1.0F}) {
      EXPECT_TRUE(meets({{x, 0.5F, -1}, 0, {zero, zero, 1}, infinity}, unit_box));
      EXPECT_TRUE(meets({{x, x, -1}, 0, {zero, zero, 1}, infinity}, unit_box));
      EXPECT_TRUE(meets({{x, 1 - x, 2}, 0, {zero, zero, -1}, infinity}, unit_box));
    }
  }
}

TEST(Slab, FlatBoxes) {
  const Box flat{{0, 0, 1}, {1, 1, 1}};
  EXPECT_TRUE(meets({{0.5F, 0.5F, 0}, 0, {0, 0, 1}, infinity}, flat));
  EXPECT_TRUE(meets({{-1, 0.5F, 1}, 0, {1, 0, 0}, infinity}, flat)) << "within its plane";
  EXPECT_TRUE(meets({{0.5F, 0.5F, 1}, 0, {1, 1, 1}, infinity}, flat)) << "from within it";
  EXPECT_FALSE(meets({{-1, 0.5F, 1.5F}, 0, {1, 0, 0}, infinity}, flat));
}

TEST(Slab, ExtremeDirections) {
  // Reciprocals that overflow or are denormal: the ray is the same as with a direction of ordinary length.
  for (const float size : {1e-45F, 1e-40F, 1e-38F, 1e-30F, 1e30F, 1e38F}) {
    const float tmax = size < 1e-37F ? infinity : 10 / size;
    EXPECT_TRUE(meets({{-2, 0.5F, 0.5F}, 0, {size, 0, 0}, tmax}, unit_box)) << size;
    EXPECT_FALSE(meets({{-2, 1.5F, 0.5F}, 0, {size, 0, 0}, tmax}, unit_box)) << size;
    EXPECT_FALSE(meets({{2, 0.5F, 0.5F}, 0, {size, 0, 0}, tmax}, unit_box)) << size;
  }
  // One tiny component beside an ordinary one: from just outside the face, it reaches the box only in the far distance.
  EXPECT_TRUE(meets({{-2, 0.5F, 0.5F}, 0, {1, 1e-40F, -1e-45F}, infinity}, unit_box));
  EXPECT_FALSE(meets({{-2, 1.5F, 0.5F}, 0, {1, 1e-40F, 0}, infinity}, unit_box));
}

TEST(Slab, DenormalAndHugeBoxes) {
  const Box tiny{{denormal, denormal, denormal}, {100 * denormal, 100 * denormal, 100 * denormal}};
  EXPECT_TRUE(meets({{0, 50 * denormal, 50 * denormal}, 0, {1, 0, 0}, infinity}, tiny));
  const Box huge{{-1e30F, -1e30F, -1e30F}, {1e30F, 1e30F, 1e30F}};
  EXPECT_TRUE(meets({{-1e31F, 0, 0}, 0, {1, 0, 0}, infinity}, huge));
  EXPECT_FALSE(meets({{-1e31F, 2e30F, 0}, 0, {1, 0, 0}, infinity}, huge));
}

TEST(Slab, NeverLosesATriangleThatIsMet) {
  // The boxes are the triangles' own, so that hits lie in faces, edges and corners; rays aim at corners and points of edges.
  const IndexedRandom random(1, 0);
  std::uint64_t next = 0;
  const auto value = [&] { return 2 * random.uniform(next++) - 1; };
  int hits = 0;
  for (int i = 0; i < 200000; ++i) {
    const float scale = std::ldexp(1.0F, i % 61 - 30);
    const Vec3 shift = i % 3 == 0 ? Vec3{1000, -500, 20} * scale : Vec3{};
    Vec3 corner[3];
    for (Vec3& c : corner) c = shift + scale * Vec3{value(), value(), value()};
    if (i % 5 == 0) corner[1][i % 3] = corner[2][i % 3] = corner[0][i % 3];
    Ray ray;
    ray.origin = shift + (3 * scale) * Vec3{value(), value(), value()};
    const float s = i % 2 == 0 ? 0 : random.uniform(next++);
    ray.direction = corner[i % 3] + s * (corner[(i + 1) % 3] - corner[i % 3]) - ray.origin;
    if (i % 7 == 0) ray.direction[(i / 7) % 3] = 0;
    const ShearedRay sheared(ray);
    TriangleHit hit;
    if (!sheared.valid || !intersect(sheared, PackedTriangle(corner[0], corner[1], corner[2]), infinity, hit)) continue;
    ++hits;
    Box box;
    for (const Vec3& c : corner) box.extend(c);
    ASSERT_TRUE(meets(ray, box)) << "case " << i;
    Ray shortened = ray;
    shortened.tmax = hit.t;
    ASSERT_TRUE(meets(shortened, box)) << "case " << i << " with the hit as the limit";
    shortened.tmin = hit.t;
    ASSERT_TRUE(meets(shortened, box)) << "case " << i << " with the hit as both ends";
  }
  EXPECT_GT(hits, 20000);
}

TEST(Watertight, HitByHand) {
  const PackedTriangle triangle({0, 0, 2}, {4, 0, 2}, {0, 4, 2});
  TriangleHit hit;
  // u weighs the second corner, v the third; t counts in directions of length 2.
  ASSERT_TRUE(intersect(ShearedRay({{1, 2, 0}, 0, {0, 0, 2}, 10}), triangle, 10, hit));
  EXPECT_EQ(hit.t, 1);
  EXPECT_EQ(hit.u, 0.25F);
  EXPECT_EQ(hit.v, 0.5F);
  ASSERT_TRUE(intersect(ShearedRay({{1, 2, 4}, 0, {0, 0, -1}, 10}), triangle, 10, hit)) << "from behind";
  EXPECT_EQ(hit.t, 2);
  EXPECT_EQ(hit.u, 0.25F);
  EXPECT_FALSE(intersect(ShearedRay({{3, 3, 0}, 0, {0, 0, 1}, 10}), triangle, 10, hit));
  EXPECT_FALSE(intersect(ShearedRay({{1, 2, 3}, 0, {0, 0, 1}, 10}), triangle, 10, hit)) << "behind the origin";
}

TEST(Watertight, EndsOfTheRangeBelongToIt) {
  const PackedTriangle triangle({0, 0, 2}, {4, 0, 2}, {0, 4, 2});
  TriangleHit hit;
  EXPECT_TRUE(intersect(ShearedRay({{1, 1, 0}, 2, {0, 0, 1}, 10}), triangle, 2, hit));
  EXPECT_FALSE(intersect(ShearedRay({{1, 1, 0}, 2.1F, {0, 0, 1}, 10}), triangle, 10, hit));
  EXPECT_FALSE(intersect(ShearedRay({{1, 1, 0}, 0, {0, 0, 1}, 10}), triangle, 1.9F, hit));
}

TEST(Watertight, EdgesAndCornersBelongToTheTriangle) {
  const PackedTriangle triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  TriangleHit hit;
  for (const Vec3 at : {Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{0, 1, 1}, Vec3{0.5F, 0, 1}, Vec3{0, 0.5F, 1}, Vec3{0.5F, 0.5F, 1}}) {
    EXPECT_TRUE(intersect(ShearedRay({{at.x, at.y, 0}, 0, {0, 0, 1}, 10}), triangle, 10, hit)) << at.x << " " << at.y;
  }
}

TEST(Watertight, EdgeOnAndWithoutArea) {
  TriangleHit hit;
  EXPECT_FALSE(
      intersect(ShearedRay({{-1, 0.25F, 1}, 0, {1, 0, 0}, 10}), PackedTriangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1}), 10, hit));
  EXPECT_FALSE(intersect(ShearedRay({{0, 0, 0}, 0, {0, 0, 1}, 10}), PackedTriangle({-1, 0, 1}, {0, 0, 1}, {1, 0, 1}), 10, hit));
  EXPECT_FALSE(intersect(ShearedRay({{0, 0, 0}, 0, {0, 0, 1}, 10}), PackedTriangle({0, 0, 1}, {0, 0, 1}, {0, 0, 1}), 10, hit));
}

TEST(Watertight, HugeAndTinyTriangles) {
  TriangleHit hit;
  for (const float size : {1e-44F, 1e-38F, 1e-20F, 1e18F, 1e30F, 1e37F}) {
    const PackedTriangle triangle({-size, -size, size}, {size, -size, size}, {0, size, size});
    ASSERT_TRUE(intersect(ShearedRay({{0, 0, 0}, 0, {0, 0, 1}, infinity}), triangle, infinity, hit)) << size;
    EXPECT_EQ(hit.t, size);
    EXPECT_FALSE(intersect(ShearedRay({{2 * size, 0, 0}, 0, {0, 0, 1}, infinity}), triangle, infinity, hit)) << size;
  }
  // The same triangle, met by a direction of extreme length.
  const PackedTriangle triangle({-1, -1, 1}, {1, -1, 1}, {0, 1, 1});
  for (const float length : {1e-38F, 1e-30F, 1e30F, 1e38F}) {
    ASSERT_TRUE(intersect(ShearedRay({{0, 0, 0}, 0, {0, 0, length}, infinity}), triangle, infinity, hit)) << length;
    EXPECT_FLOAT_EQ(hit.t, 1 / length);
  }
  EXPECT_FALSE(intersect(ShearedRay({{0, 0, 0}, 0, {0, 0, 1e-45F}, infinity}), triangle, infinity, hit)) << "t is no float";
}

TEST(Watertight, NothingSlipsThroughAFan) {
  // Triangles around a common corner, all in general position: rays at the corner and along the edges must meet one of them.
  const IndexedRandom random(2, 0);
  std::uint64_t next = 0;
  const auto value = [&] { return 2 * random.uniform(next++) - 1; };
  for (int i = 0; i < 5000; ++i) {
    constexpr int spokes = 7;
    const Vec3 shift = i % 2 == 0 ? Vec3{} : Vec3{300 * value(), 300 * value(), 300 * value()};
    const Vec3 hub = shift + 0.1F * Vec3{value(), value(), value()};
    Vec3 rim[spokes];
    for (int k = 0; k < spokes; ++k) {
      const float angle = 6.2831853F * (static_cast<float>(k) + 0.4F * random.uniform(next++)) / spokes;
      rim[k] = shift + Vec3{std::cos(angle), std::sin(angle), 0.3F * value()};
    }
    for (int k = 0; k < spokes; ++k) {
      Ray ray;
      ray.origin = shift + Vec3{0.3F * value(), 0.3F * value(), -2};
      const float s = k == 0 ? 0 : 0.9F * random.uniform(next++);
      ray.direction = hub + s * (rim[k] - hub) - ray.origin;
      const ShearedRay sheared(ray);
      bool met = false;
      for (int j = 0; j < spokes; ++j) {
        TriangleHit hit;
        met = met || intersect(sheared, PackedTriangle(hub, rim[j], rim[(j + 1) % spokes]), infinity, hit);
      }
      ASSERT_TRUE(met) << "fan " << i << ", spoke " << k;
    }
  }
}

}  // namespace
}  // namespace raystudy
