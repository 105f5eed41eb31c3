// The collapse against all there are, the encoding against what it stands for, and hits against those of testing every triangle.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "methods/wide/collapse.h"
#include "methods/wide/kernels.h"
#include "methods/wide/node_write.h"
#include "methods/wide/wide_ray.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/trees.h"

namespace raystudy::wide {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

/// The least cost of node `n` as at most `trees` children, by trying everything.
double least_cost(const Bvh2& bvh, const CollapseCosts& costs, int width, std::uint32_t n, int trees) {
  const Bvh2Node& node = bvh.nodes[n];
  const auto m = static_cast<double>(node.box.half_area());
  std::uint32_t triangles = 0;
  const std::function<void(std::uint32_t)> add = [&](std::uint32_t i) {
    if (bvh.nodes[i].is_leaf()) {
      triangles += bvh.nodes[i].count;
    } else {
      add(bvh.nodes[i].first);
      add(bvh.nodes[i].first + 1);
    }
  };
  add(n);
  const double as_leaf =
      m * (static_cast<double>(costs.leaf) + static_cast<double>(costs.triangle) * static_cast<double>(triangles));
  if (node.is_leaf()) return as_leaf;
  const auto divided = [&](int parts) {
    double least = std::numeric_limits<double>::infinity();
    for (int left = 1; left < parts; ++left) {
      least = std::min(
          least, least_cost(bvh, costs, width, node.first, left) + least_cost(bvh, costs, width, node.first + 1, parts - left));
    }
    return least;
  };
  double least = m * static_cast<double>(costs.node) + divided(width);
  if (triangles <= costs.most_in_leaf) least = std::min(least, as_leaf);
  for (int parts = 2; parts <= trees; ++parts) least = std::min(least, divided(parts));
  return least;
}

template <int W>
void expect_optimal(const Bvh2& bvh, const CollapseCosts& costs) {
  const double expected = least_cost(bvh, costs, W, 0, 1);
  EXPECT_NEAR(OptimalCollapse<W>(bvh, SurfaceArea(), costs).cost(), expected, 1e-5 * expected);
}

TEST(Collapse, CostsTheLeastOfAll) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(9, seed));
    const Bvh2 bvh = test::random_tree(scene, seed, seed % 2 == 0 ? 1 : 3);
    for (const CollapseCosts costs :
         {CollapseCosts{1, 1, 0, 4}, CollapseCosts{1, 0.2F, 0.5F, 16}, CollapseCosts{0.5F, 2, 0.1F, 1}}) {
      expect_optimal<4>(bvh, costs);
      expect_optimal<8>(bvh, costs);
    }
  }
}

/// Four unit boxes in a row, as a tree of pairs: with leaves for nothing and nodes at 1, the best is one node with four leaves;
/// where triangles in a leaf cost nothing either, one leaf.
TEST(Collapse, OfFourBoxesByHand) {
  const Scene scene =
      test::scene_of({{{0, 0, 0}, {1, 1, 1}}, {{1, 0, 0}, {2, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}, {{3, 0, 0}, {4, 1, 1}}});
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, "sweep-sah"));
  const auto tree = builder->build(scene, {});
  const auto& bvh = dynamic_cast<const Bvh2&>(*tree);
  // Half areas: 9 of all four, 3 of one. One node with four leaves of one triangle: 9 + 4 · 3 · 0.5 = 15.
  const OptimalCollapse<4> nodes(bvh, SurfaceArea(), {1, 0.25F, 0.25F, 1});
  EXPECT_FLOAT_EQ(static_cast<float>(nodes.cost()), 15);
  std::array<std::uint32_t, 4> children{};
  EXPECT_EQ(nodes.children(0, children), 4U);
  // As one leaf: 9 · (0.25 + 4 · 0.25) = 11.25.
  const OptimalCollapse<4> leaf(bvh, SurfaceArea(), {1, 0.25F, 0.25F, 4});
  EXPECT_FLOAT_EQ(static_cast<float>(leaf.cost()), 11.25F);
  EXPECT_TRUE(leaf.is_leaf(0));
}

TEST(Collapse, TakesNodesInAnyOrder) {
  const Scene scene = test::scene_of(test::random_boxes(200, 3));
  const Bvh2 bvh = test::random_tree(scene, 3, 2);
  const std::vector<std::uint32_t> order = children_first(bvh);
  ASSERT_EQ(order.size(), bvh.nodes.size() - 1);
  std::vector<std::size_t> place(bvh.nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  for (const std::uint32_t n : order) {
    if (bvh.nodes[n].is_leaf()) continue;
    EXPECT_GT(place[n], std::max(place[bvh.nodes[n].first], place[bvh.nodes[n].first + 1]));
  }
}

TEST(QuantizedBoxes, HoldThoseTheyStandForAndLittleMore) {
  const std::vector<Box> boxes = test::random_boxes(8, 5);
  Box all;
  for (const Box& box : boxes) all.extend(box);
  QuantizedNode<8> node{};
  set_boxes(node, boxes);
  ASSERT_EQ(node.used(), 8);
  for (int i = 0; i < 8; ++i) {
    const Box box = node.box(i);
    EXPECT_TRUE(box.contains(boxes[static_cast<std::size_t>(i)]));
    for (int axis = 0; axis < 3; ++axis) {
      // A step is less than 2 / 255 of the node's extent.
      const float step = all.extent()[axis] * (2.0F / 255);
      EXPECT_LE(boxes[static_cast<std::size_t>(i)].lower[axis] - box.lower[axis], step);
      EXPECT_LE(box.upper[axis] - boxes[static_cast<std::size_t>(i)].upper[axis], step);
    }
  }
  node = {};
  set_boxes(node, std::span(boxes).first(3));
  EXPECT_EQ(node.used(), 3);
  EXPECT_TRUE(node.box(3).is_empty());
}

TEST(SlotOrders, AreFromTheFarthestForEachOctant) {
  const std::vector<Box> boxes{{{0, 0, 0}, {1, 1, 1}}, {{5, 0, 0}, {6, 1, 1}}, {{0, 9, 0}, {1, 10, 1}}};
  const SlotOrders<4> orders = slot_orders<4>(boxes);
  EXPECT_EQ(orders[0], (std::array<std::uint8_t, 4>{3, 2, 1, 0}));  // up along all axes: the box at the origin comes first
  EXPECT_EQ(orders[1], (std::array<std::uint8_t, 4>{3, 2, 0, 1}));  // down along x: that at x = 5
  EXPECT_EQ(orders[2], (std::array<std::uint8_t, 4>{3, 1, 0, 2}));  // down along y: that at y = 9
  EXPECT_EQ(orders[3], (std::array<std::uint8_t, 4>{3, 0, 1, 2}));
  // Of equals the earlier comes first.
  EXPECT_EQ(slot_orders<4>(std::vector<Box>{boxes[1], boxes[0], boxes[0], boxes[1]})[0],
            (std::array<std::uint8_t, 4>{0, 3, 1, 2}));
}

TEST(WideRay, IsInvalidWhereItCanHitNothing) {
  const SlabScene scene(Box({-1, -1, -1}, {1, 1, 1}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(WideRay({{0, 0, 0}, 0, {0, 0, 1}}, scene).valid);
  EXPECT_FALSE(WideRay({{0, 0, 0}, 0, {0, 0, 0}}, scene).valid);
  EXPECT_FALSE(WideRay({{nan, 0, 0}, 0, {0, 0, 1}}, scene).valid);
  EXPECT_FALSE(WideRay({{0, 0, 0}, 0, {0, infinity, 1}}, scene).valid);
  EXPECT_FALSE(WideRay({{0, 0, 0}, -1, {0, 0, 1}}, scene).valid);
  EXPECT_FALSE(WideRay({{0, 0, 0}, 2, {0, 0, 1}, 1}, scene).valid);
  EXPECT_FALSE(WideRay({{0, 0, 0}, 0, {0, 0, 1}, nan}, scene).valid);
}

/// Its axes and shears are those of the scalar test, ties included, so that hits can be the same.
TEST(WideRay, IsShearedAsTheScalarTestDoes) {
  const SlabScene scene(Box({-1, -1, -1}, {1, 1, 1}));
  std::vector<Ray> rays = test::random_rays(2000, 7);
  for (const Vec3 d :
       {Vec3{1, 1, 1}, Vec3{1, 1, 0}, Vec3{0, 1, -1}, Vec3{-1, 0, 1}, Vec3{0, 0, -1}, Vec3{0, -2, 0}, Vec3{3, 0, 0}}) {
    rays.push_back({{0.5F, 0.25F, 2}, 0, d});
  }
  for (const Ray& ray : rays) {
    const ShearedRay expected(ray);
    const WideRay found(ray, scene);
    ASSERT_EQ(found.valid, expected.valid);
    if (!found.valid) continue;
    ASSERT_EQ(found.along, expected.along);
    ASSERT_EQ(found.across, expected.across);
    ASSERT_EQ(found.up, expected.up);
    ASSERT_EQ(found.shear_across, _mm_cvtss_f32(expected.shear_across));
    ASSERT_EQ(found.shear_up, _mm_cvtss_f32(expected.shear_up));
  }
}

/// Node for node and triangle for triangle, where subtrees are small enough to be tasks and where the tree has one leaf.
TEST(Schedule, OfCoherentRaysIsOneByOneInTreesOfLessThan16MiB) {
  constexpr std::size_t large = std::size_t{16} << 20U;
  EXPECT_EQ(best_schedule(true, large - 1), Schedule::one_by_one);
  EXPECT_EQ(best_schedule(true, large), Schedule::in_turns);
  EXPECT_EQ(best_schedule(false, 0), Schedule::in_turns);
}

TEST(Encoding, IsTheSameForAnyThreads) {
  const Registry& registry = Registry::instance();
  for (const int triangles : {1, 40, 3000}) {
    const Scene scene = test::soup(triangles, 0.3F, 1);
    for (const std::uint32_t leaf_triangles : {1U, 5U, 60U}) {
      const Bvh2 bvh = test::random_tree(scene, 4, leaf_triangles);
      for (const char* name : {"bvh4", "bvh8", "bvh16"}) {
        for (const char* boxes : {"float", "8-bit"}) {
          const auto encoder = registry.create<Encoder>(registry.ref(Role::encoder, name, {{"boxes", std::string(boxes)}}));
          const auto encoded = [&](int threads) {
            BuildContext context;
            context.threads = threads;
            auto accel = encoder->encode(bvh, scene, context);
            return std::unique_ptr<WideBvh>(dynamic_cast<WideBvh*>(accel.release()));
          };
          const auto one = encoded(1);
          for (const int threads : {2, 3}) {
            const auto many = encoded(threads);
            EXPECT_TRUE(one->nodes == many->nodes) << name << " " << boxes << " " << triangles;
            EXPECT_EQ(one->triangles, many->triangles);
            EXPECT_TRUE(one->corners == many->corners);
            EXPECT_EQ(one->height, many->height);
          }
        }
      }
    }
  }
}

TEST(Encoding, OfTrianglesWithSeveralReferencesIsTheSameForAnyThreads) {
  const Registry& registry = Registry::instance();
  const Scene scene = test::soup(3000, 0.3F, 1);
  const auto tree = registry.create<Builder>(registry.ref(Role::builder, "sbvh"))->build(scene, {});
  const auto& bvh = dynamic_cast<const Bvh2&>(*tree);
  const auto encoder = registry.create<Encoder>(registry.ref(Role::encoder, "bvh8"));
  std::vector<std::unique_ptr<Accel>> encoded;
  for (const int threads : {1, 2, 3}) {
    BuildContext context;
    context.threads = threads;
    encoded.push_back(encoder->encode(bvh, scene, context));
  }
  const auto& one = dynamic_cast<const WideBvh&>(*encoded[0]);
  ASSERT_LT(one.triangles.size(), bvh.triangles.size()) << "no leaf was joined of two references to a triangle";
  for (const std::size_t i : {1U, 2U}) {
    const auto& many = dynamic_cast<const WideBvh&>(*encoded[i]);
    EXPECT_TRUE(one.nodes == many.nodes);
    EXPECT_EQ(one.triangles, many.triangles);
    EXPECT_TRUE(one.corners == many.corners);
  }
}

struct Case {
  std::string encoder;
  Changes encoding;
  std::string schedule;
  std::string simd;
};

class WideTracing : public testing::TestWithParam<Case> {};

TEST_P(WideTracing, HitsAreThoseOfTestingEveryTriangle) {
  const Case& c = GetParam();
  const Registry& registry = Registry::instance();
  const auto encoder = registry.create<Encoder>(registry.ref(Role::encoder, c.encoder, c.encoding));
  const auto tracer = registry.create<Tracer>(registry.ref(Role::tracer, "wide", {{"schedule", c.schedule}, {"simd", c.simd}}));
  for (const int triangles : {1, 7, 400}) {
    const Scene scene = test::soup(triangles, 0.3F, 1);
    const std::vector<Ray> rays = test::random_rays(2500, 2);
    const std::vector<Hit> expected = test::closest_hits(scene, rays);
    for (const std::uint32_t leaf_triangles : {1U, 5U, 60U}) {
      const Bvh2 bvh = test::random_tree(scene, 4, leaf_triangles);
      const auto wide = encoder->encode(bvh, scene, {});
      ASSERT_TRUE(find_problems(*wide, scene).empty());
      const auto session = tracer->prepare(*wide, scene, 1, false);
      std::vector<Hit> hits(rays.size());
      session->trace(rays, hits, Query::closest_hit);
      test::expect_same(expected, hits);
      session->trace(rays, hits, Query::any_hit);
      for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_EQ(hits[i].is_hit(), expected[i].is_hit()) << "ray " << i;
    }
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* encoder : {"bvh4", "bvh8", "bvh16"}) {
    for (const char* boxes : {"float", "8-bit"}) {
      for (const char* schedule : {"one-by-one", "in-turns"}) {
        for (const char* simd : {"auto", "avx2"}) {
          all.push_back({encoder, {{"boxes", std::string(boxes)}, {"max_leaf_triangles", std::int64_t{12}}}, schedule, simd});
        }
      }
    }
  }
  return all;
}

std::string text(const Case& c) {
  std::string name = c.encoder + "_" + std::get<std::string>(c.encoding.at("boxes")) + "_" + c.schedule + "_" + c.simd;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
std::string case_name(const testing::TestParamInfo<Case>& info) { return text(info.param); }
void PrintTo(const Case& c, std::ostream* out) { *out << text(c); }

INSTANTIATE_TEST_SUITE_P(All, WideTracing, testing::ValuesIn(cases()), case_name);

}  // namespace
}  // namespace raystudy::wide
