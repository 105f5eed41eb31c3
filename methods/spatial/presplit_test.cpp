#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "harness/accel/coverage.h"
#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "methods/spatial/presplit_records.h"
#include "tests/support/same_tree.h"

namespace raystudy::spatial {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Scene soup_of(std::vector<Vec3> vertices) {
  Scene scene;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.push_back({{i, i + 1, i + 2}});
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  return scene;
}

/// Thin triangles of up to `length`, in any direction.
Scene splinters(std::size_t n, float length, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random()) / 4294967296.0F; };
  const auto vector = [&] { return Vec3{number() - 0.5F, number() - 0.5F, number() - 0.5F}; };
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 at{number(), number(), number()};
    const Vec3 other = at + vector() * length;
    vertices.insert(vertices.end(), {at, other, other + vector() * 0.001F});
  }
  return soup_of(std::move(vertices));
}

Bvh2 build(std::string_view name, const Scene& scene, const Changes& changes = {}, int threads = 1) {
  BuildContext context;
  context.threads = threads;
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name, changes));
  return dynamic_cast<const Bvh2&>(*builder->build(scene, context));
}

topdown::BoxRecord record_of(const Scene& scene, std::uint32_t triangle) {
  return topdown::BoxRecord::of(scene.triangle_box(triangle), triangle);
}

TEST(MedianPlanes, HalveTheSceneThenItsHalves) {
  const MedianPlanes planes({{0, 0, 0}, {8, 16, 8}});
  const auto expect = [&](const Box& box, int axis, int level, float at) {
    const auto plane = planes.most_important(box);
    EXPECT_EQ(plane.axis, axis);
    EXPECT_EQ(plane.level, level);
    EXPECT_EQ(plane.at, at);
  };
  expect({{3, 9, 0}, {5, 15, 1}}, 0, 0, 4);  // y: 12, of level 1
  expect({{3, 7, 0}, {5, 15, 1}}, 1, 0, 8);  // both of level 0: the longest extent
  expect({{4, 0, 0}, {7, 8, 1}}, 1, 1, 4);   // what touches a plane is not crossed by it; x: 6, of level 1
  expect({{0, 0, 2.5F}, {0, 0, 3.5F}}, 2, 2, 3);
  EXPECT_EQ(planes.most_important({{1, 1, 1}, {1, 1, 1}}).axis, -1);
  EXPECT_EQ(MedianPlanes({{1, 1, 1}, {1, 1, 1}}).most_important({{1, 1, 1}, {1, 1, 1}}).axis, -1);
}

// In a scene of 8 x 8 x 8 (surface area 384). A: from (0, 0, 0) over (2, 2, 0) to (2, 2, 2). Box 2 x 2 x 2, area 24; cross
// product of (2, 2, 0) and (2, 2, 2): (4, -4, 0), sum 8. Its most important plane is at 1: 0 < 1 < 2 < 4 < 8, level 2. B: half a
// square in the plane z = 1, from 3 to 5: box 2 x 2 x 0, area 8; cross product (0, 0, 4). Level 0, at 4.
TEST(SplitPriority, IsThatOfThePaper) {
  const Scene scene =
      soup_of({{0, 0, 0}, {2, 2, 0}, {2, 2, 2}, {3, 3, 1}, {5, 3, 1}, {3, 5, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}});
  const MedianPlanes planes({{0, 0, 0}, {8, 8, 8}});
  EXPECT_FLOAT_EQ(split_priority(scene, planes, record_of(scene, 0)), std::cbrt((24.0F - 8) / 384 / 4));
  EXPECT_FLOAT_EQ(split_priority(scene, planes, record_of(scene, 1)), std::cbrt((8.0F - 4) / 384));
  EXPECT_EQ(split_priority(scene, planes, record_of(scene, 2)), 0);
}

TEST(SplitScale, SpendsTheBudgetAsFarAsItGoes) {
  std::mt19937 random(3);
  std::vector<float> priorities(5000);
  for (float& p : priorities) p = std::cbrt(static_cast<float>(random()) / 4294967296.0F);
  const auto sum = [&](float scale) {
    return std::accumulate(priorities.begin(), priorities.end(), std::uint64_t{0},
                           [&](std::uint64_t s, float p) { return s + split_count(scale, p); });
  };
  for (const std::uint64_t budget : {0, 1, 100, 1500, 80000}) {
    const float scale = split_scale(priorities, budget, 1);
    EXPECT_EQ(sum(scale), budget);  // no two are equal, so that one comes after another
    EXPECT_EQ(split_scale(priorities, budget, 2), scale);
  }
  // Equal ones are split all or none: 3 · 2 <= 7 < 3 · 3.
  EXPECT_EQ(split_count(split_scale(std::vector<float>(3, 0.5F), 7, 1), 0.5F), 2U);
  EXPECT_EQ(split_count(split_scale(std::vector<float>(3, 0.0F), 7, 1), 0.0F), 0U);
}

TEST(PresplitRecords, KeepTheBudgetAndCoverEveryTriangle) {
  for (const auto& [scene, budget] : {std::pair{splinters(10000, 0.5F, 1), 0.3},
                                      {splinters(500, 1e30F, 2), 2.0},
                                      {splinters(500, 1e-38F, 3), 16.0},
                                      {splinters(1, 1, 4), 16.0}}) {
    const std::size_t n = scene.triangles.size();
    PresplitRecords parts(scene, budget, 1);
    const auto records = parts.records();
    EXPECT_LE(static_cast<double>(records.size()), static_cast<double>(n) * (1 + budget));
    EXPECT_GT(records.size(), n);
    std::vector<std::vector<Box>> boxes(n);
    for (const topdown::BoxRecord& record : records) boxes[record.triangle].push_back(topdown::WideBox::of(record).box());
    for (std::uint32_t t = 0; t < n; ++t) {
      const Box whole = scene.triangle_box(t);
      for (const Box& box : boxes[t]) EXPECT_TRUE(whole.contains(box));
      const Triangle& corners = scene.triangles[t];
      EXPECT_TRUE(boxes_cover(boxes[t], {scene.vertices[corners[0]], scene.vertices[corners[1]], scene.vertices[corners[2]]}));
    }
  }
}

// Along x from end to end of a scene of 8 x 8 x 8, within one cell of 1 x 1 x 1 on the other axes but for the plane z = 1.5 of
// level 3: the planes of levels 0 to 2 are across x, and seven splits make eight equal parts.
TEST(PresplitRecords, HalveATriangleAgainAndAgain) {
  const Scene scene =
      soup_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 1, 1}, {8, 1.5F, 1.75F}, {8, 1.5F, 1.75F}, {8, 8, 8}, {8, 8, 8}, {8, 8, 8}});
  PresplitRecords parts(scene, 7.1 / 3, 1);
  ASSERT_EQ(parts.records().size(), 10U);
  for (std::size_t i = 0; i < 8; ++i) {
    const auto& record = parts.records()[1 + i];
    EXPECT_EQ(record.triangle, 1U);
    const auto x = static_cast<float>(i);
    EXPECT_EQ(record.lower[0], x);
    EXPECT_EQ(-record.negated_upper[0], x + 1);
    EXPECT_NEAR(record.lower[1], 1 + x / 16, 1e-4F);
    EXPECT_NEAR(-record.negated_upper[1], 1 + (x + 1) / 16, 1e-4F);
  }
}

TEST(Presplit, WithoutABudgetIsBinnedSah) {
  const Scene scene = splinters(2000, 0.3F, 5);
  EXPECT_TRUE(test::same(build("presplit", scene, {{"budget", 0.0}}), build("binned-sah", scene)));
}

TEST(Presplit, MakesOneValidTreeWhateverTheThreads) {
  const Scene scene = splinters(40000, 0.2F, 6);
  for (const char* leaves : {"single", "sah"}) {
    const Changes changes{{"leaves", std::string(leaves)}};
    const Bvh2 one = build("presplit", scene, changes);
    EXPECT_TRUE(one.duplicates);
    EXPECT_THAT(find_problems(one, scene), testing::IsEmpty());
    for (const int threads : {2, 3}) EXPECT_TRUE(test::same(one, build("presplit", scene, changes, threads))) << threads;
  }
}

TEST(Presplit, MakesCheaperTreesOfLongTrianglesTheMoreItMaySplit) {
  const Scene scene = splinters(5000, 0.5F, 7);
  double last = tree_cost(build("binned-sah", scene), CostModel{});
  for (const double budget : {0.3, 1.0, 4.0}) {
    const double cost = tree_cost(build("presplit", scene, {{"budget", budget}}), CostModel{});
    EXPECT_LT(cost, last) << budget;
    last = cost;
  }
}

}  // namespace
}  // namespace raystudy::spatial
