#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <limits>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

Scene soup_of(std::vector<Vec3> vertices) {
  Scene scene;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.push_back({{i, i + 1, i + 2}});
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  return scene;
}

Bvh2 sweep(const Scene& scene, std::string positions) {
  const auto ref = Registry::instance().ref(Role::builder, "sweep-sah", {{"positions", std::move(positions)}});
  const auto accel = Registry::instance().create<Builder>(ref)->build(scene, {});
  return dynamic_cast<const Bvh2&>(*accel);
}

// Three unit right triangles in the planes x = 0, 1 and 9: the best split parts the third from the others.
TEST(SweepSah, PartsTheFarTriangle) {
  std::vector<Vec3> vertices;
  for (const float x : {9.0F, 0.0F, 1.0F}) vertices.insert(vertices.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
  const Scene scene = soup_of(vertices);
  const Bvh2 bvh = sweep(scene, "box-centers");
  EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(1, 2, 0));
  // Half areas: root 9 x 1 x 1: 19; the pair 1 x 1 x 1: 3; a triangle's box 1. (3 (19 + 3) + 2 (1 + 1 + 1)) / 19.
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 72.0 / 19);
}

// Plates at 3, 3, 4 and 4 around a box over [0, 7]; the half area of length l is 1 + 2 l. By lower bound the long box comes
// first: 1 | 4 costs 15 + 4 · 3 = 27. By center it stands in the middle: 2 | 3 costs 2 · 1 + 3 · 15 = 47, as does 3 | 2, 1 | 4
// costs 61.
TEST(SweepSah, WithBoxBoundsPartsALongBoxFromShortOnesInsideIt) {
  std::vector<Vec3> vertices;
  for (const auto& [a, b] : {std::pair{3.0F, 3.0F}, {3.0F, 3.0F}, {0.0F, 7.0F}, {4.0F, 4.0F}, {4.0F, 4.0F}}) {
    vertices.insert(vertices.end(), {{a, 0, 0}, {b, 1, 0}, {b, 0, 1}});
  }
  const Scene scene = soup_of(vertices);
  const Bvh2 by_bounds = sweep(scene, "box-bounds");
  EXPECT_EQ(by_bounds.nodes[2].box, Box({0, 0, 0}, {7, 1, 1}));
  EXPECT_EQ(by_bounds.nodes[3].box, Box({3, 0, 0}, {4, 1, 1}));
  const Bvh2 by_centers = sweep(scene, "box-centers");
  EXPECT_EQ(by_centers.nodes[2].box, Box({3, 0, 0}, {3, 1, 1}));
  EXPECT_EQ(by_centers.nodes[3].box, Box({0, 0, 0}, {7, 1, 1}));
}

/// What sweep-sah must do, the slow way: every node sorts its triangles anew. Sums the measures of inner nodes and of leaves.
class Reference {
 public:
  Reference(const Scene& scene, std::string positions) : scene_(scene), positions_(std::move(positions)) {
    std::vector<std::uint32_t> all(scene.triangles.size());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    build(all, true);
  }
  [[nodiscard]] double cost() const { return root_ > 0 ? (3 * inner_ + 2 * leaf_) / root_ : 3 * nodes_ + 2 * (nodes_ + 1); }

 private:
  [[nodiscard]] float position(std::uint32_t t, int order) const {
    const Box box = scene_.triangle_box(t);
    if (positions_ == "box-bounds") return order % 2 == 0 ? box.lower[order / 2] : box.upper[order / 2];
    if (positions_ == "box-centers") return 0.5F * box.lower[order] + 0.5F * box.upper[order];
    float sum = 0;
    for (int i = 0; i < 3; ++i) sum += scene_.vertices[scene_.triangles[t][i]][order] * (1.0F / 3);
    return sum;
  }

  void build(const std::vector<std::uint32_t>& triangles, bool root) {
    const std::size_t n = triangles.size();
    Box box;
    for (const std::uint32_t t : triangles) box.extend(scene_.triangle_box(t));
    if (root) root_ = static_cast<double>(box.half_area());
    if (n == 1) {
      leaf_ += static_cast<double>(box.half_area());
      return;
    }
    inner_ += static_cast<double>(box.half_area());
    ++nodes_;
    const int orders = positions_ == "box-bounds" ? 6 : 3;
    float best = std::numeric_limits<float>::infinity();
    std::size_t best_left = 0;
    int best_order = 0;
    for (int order = 0; order < orders; ++order) {
      const std::vector<std::uint32_t> list = sorted(triangles, order);
      float order_best = std::numeric_limits<float>::infinity();
      std::size_t order_left = 0;
      for (std::size_t left = 1; left < n; ++left) {
        const float cost =
            half_area(list, 0, left) * static_cast<float>(left) + half_area(list, left, n) * static_cast<float>(n - left);
        const auto off = [&](std::size_t l) { return l * 2 > n ? l * 2 - n : n - l * 2; };
        if (cost < order_best || (cost == order_best && off(left) < off(order_left))) {
          order_best = cost;
          order_left = left;
        }
      }
      if (order_best < best) {
        best = order_best;
        best_left = order_left;
        best_order = order;
      }
    }
    if (best_left == 0 || !(box.half_area() > 0)) {
      best_left = n / 2;
      best_order = box.longest_axis() * orders / 3;
    }
    if (n == 2) best_order = 0;
    const std::vector<std::uint32_t> list = sorted(triangles, best_order);
    const auto middle = list.begin() + static_cast<std::ptrdiff_t>(best_left);
    build({list.begin(), middle}, false);
    build({middle, list.end()}, false);
  }

  [[nodiscard]] std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> list, int order) const {
    std::sort(list.begin(), list.end());
    std::stable_sort(list.begin(), list.end(), [&](auto a, auto b) { return position(a, order) < position(b, order); });
    return list;
  }
  [[nodiscard]] float half_area(const std::vector<std::uint32_t>& list, std::size_t begin, std::size_t end) const {
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.extend(scene_.triangle_box(list[i]));
    return box.half_area();
  }

  const Scene& scene_;
  std::string positions_;
  double root_ = 0;
  double inner_ = 0;
  double leaf_ = 0;
  double nodes_ = 0;
};

// Coordinates on a coarse grid, so that equal positions, equal costs and flat boxes are many.
TEST(SweepSah, MakesTheTreeOfTheSlowReference) {
  for (const char* positions : {"box-centers", "centroids", "box-bounds"}) {
    EXPECT_TRUE(rc::check(std::string("same cost as the reference, positions: ") + positions, [positions] {
      const auto count = *rc::gen::inRange(1, 60);
      const auto grid = *rc::gen::element(2, 9, 1000);
      std::vector<Vec3> vertices;
      for (int i = 0; i < 3 * count; ++i) {
        const auto number = [&] { return static_cast<float>(*rc::gen::inRange(0, grid)); };
        const float x = number();
        const float y = number();
        vertices.emplace_back(x, y, number());
      }
      const Scene scene = soup_of(vertices);
      const Bvh2 bvh = sweep(scene, positions);
      const double expected = Reference(scene, positions).cost();
      RC_ASSERT(std::abs(tree_cost(bvh, {}) - expected) <= 1e-9 * expected);
      RC_ASSERT(find_problems(bvh, scene).empty());
    }));
  }
}

}  // namespace
}  // namespace raystudy
