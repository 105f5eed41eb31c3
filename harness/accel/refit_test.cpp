#include "harness/accel/refit.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <stdexcept>

#include "harness/accel/node_order.h"
#include "harness/accel/validate.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

constexpr RefitMethod methods[]{RefitMethod::serial, RefitMethod::subtrees, RefitMethod::atomics};

/// The boxes as they must be, by recursion from the triangles.
Box box_from_scratch(const Bvh2& bvh, const Scene& scene, std::uint32_t n) {
  const Bvh2Node& node = bvh.nodes[n];
  if (!node.is_leaf()) return united(box_from_scratch(bvh, scene, node.first), box_from_scratch(bvh, scene, node.first + 1));
  Box box;
  for (std::uint32_t i = node.first; i < node.first + node.count; ++i) box.extend(scene.triangle_box(bvh.triangles[i]));
  return box;
}

void expect_right_boxes(const Bvh2& bvh, const Scene& scene) {
  for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n) {
    if (n == 1) continue;
    ASSERT_EQ(bvh.nodes[n].box, box_from_scratch(bvh, scene, n)) << "node " << n;
  }
}

/// Boxes elsewhere, of the same number.
Scene moved(std::size_t count) { return test::scene_of(test::random_boxes(count, 77)); }

TEST(Refit, GivesTheBoxesOfTheMovedTriangles) {
  for (const std::size_t count : {1U, 2U, 3U, 10U, 1000U, 20000U}) {
    for (const std::uint32_t leaf_triangles : {1U, 5U}) {
      const Scene before = test::scene_of(test::random_boxes(count, 1));
      const Scene after = moved(count);
      const Bvh2 first = test::random_tree(before, 1, leaf_triangles);
      for (const RefitMethod method : methods) {
        for (const int threads : {1, 2}) {
          Bvh2 bvh = first;
          Refitter refitter(bvh, before.triangles, method, threads);
          refitter.refit(bvh, after.vertices);
          expect_right_boxes(bvh, after);
          EXPECT_THAT(find_problems(bvh, after), testing::IsEmpty());
          EXPECT_EQ(bvh.triangles, first.triangles);
          refitter.refit(bvh, before.vertices);
          EXPECT_TRUE(test::same(bvh, first)) << "there and back again";
        }
      }
    }
  }
}

TEST(Refit, IsTheSameBitForBitByEveryMethod) {
  const Scene before = test::scene_of(test::random_boxes(20000, 1));
  const Scene after = moved(20000);
  std::vector<Vec3> zeros;  // of both signs, between which min and max choose by their order
  for (std::size_t i = 0; i < before.vertices.size(); ++i) zeros.emplace_back(i % 3 == 0 ? -0.0F : 0.0F);
  const Bvh2 first = test::random_tree(before, 1, 2);
  for (const std::span<const Vec3> vertices : {std::span<const Vec3>(after.vertices), std::span<const Vec3>(zeros)}) {
    Bvh2 serial = first;
    Refitter(serial, before.triangles, RefitMethod::serial, 1).refit(serial, vertices);
    for (const RefitMethod method : methods) {
      for (const int threads : {1, 2, 3}) {
        Bvh2 bvh = first;
        Refitter(bvh, before.triangles, method, threads).refit(bvh, vertices);
        EXPECT_TRUE(test::same(bvh, serial));
      }
    }
  }
}

TEST(Refit, WorksWhereverNodesLie) {
  const Scene before = test::scene_of(test::random_boxes(5000, 1));
  const Scene after = moved(5000);
  for (const std::string& order : node_order_names()) {
    Bvh2 first = test::random_tree(before, 1, 2);
    arrange(first, node_order(order), Pages::normal);
    // Children before parents: what nothing in a Bvh2 forbids.
    Bvh2 backwards = first;
    const auto pairs = static_cast<std::uint32_t>(first.nodes.size() / 2);
    const auto place = [&](std::uint32_t pair) { return pair == 0 ? 0 : pairs - pair; };
    for (std::uint32_t n = 0; n < first.nodes.size(); ++n) {
      Bvh2Node node = first.nodes[n];
      if (n != 1 && !node.is_leaf()) node.first = 2 * place(node.first / 2);
      backwards.nodes[2 * place(n / 2) + n % 2] = node;
    }
    for (const Bvh2& tree : {first, backwards}) {
      for (const RefitMethod method : methods) {
        Bvh2 bvh = tree;
        Refitter(bvh, before.triangles, method, 2).refit(bvh, after.vertices);
        EXPECT_THAT(find_problems(bvh, after), testing::IsEmpty()) << order;
        expect_right_boxes(bvh, after);
      }
    }
  }
}

TEST(Refit, TakesWholeTrianglesInTreesOfSpatialSplits) {
  Scene scene = test::scene_of({Box{{0, 0, 0}, {4, 4, 4}}});
  Bvh2 bvh;  // one triangle in two leaves, each with the half of it along x
  bvh.nodes = {{scene.bounds, 2, 0}, {}, {{{0, 0, 0}, {2, 4, 4}}, 0, 1}, {{{2, 0, 0}, {4, 4, 4}}, 1, 1}};
  bvh.triangles = {0, 0};
  bvh.duplicates = true;
  ASSERT_THAT(find_problems(bvh, scene), testing::IsEmpty());
  for (const RefitMethod method : methods) {
    Refitter(bvh, scene.triangles, method, 1).refit(bvh, scene.vertices);
    EXPECT_EQ(bvh.nodes[2].box, scene.bounds);
    EXPECT_EQ(bvh.nodes[3].box, scene.bounds);
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
  }
}

TEST(Refit, OfAnEmptyTreeDoesNothing) {
  Bvh2 bvh;
  for (const RefitMethod method : methods) EXPECT_NO_THROW(Refitter(bvh, {}, method, 2).refit(bvh, {}));
}

TEST(Refit, RefusesAnotherTree) {
  const Scene scene = test::scene_of(test::random_boxes(10, 1));
  Bvh2 bvh = test::random_tree(scene, 1);
  Bvh2 other = test::random_tree(scene, 1, 4);
  EXPECT_THROW(Refitter(bvh, scene.triangles, RefitMethod::serial, 1).refit(other, scene.vertices), std::logic_error);
}

TEST(Refit, LeavesTheSlotBesideTheRootAlone) {
  const Scene before = test::scene_of(test::random_boxes(100, 1));
  const Scene after = moved(100);
  for (const RefitMethod method : methods) {
    Bvh2 bvh = test::random_tree(before, 1);
    bvh.nodes[1] = {Box{{1, 2, 3}, {4, 5, 6}}, 4'000'000'000U, 7};  // looks like a leaf far behind the last triangle
    const Bvh2Node beside = bvh.nodes[1];
    Refitter(bvh, before.triangles, method, 2).refit(bvh, after.vertices);
    EXPECT_EQ(bvh.nodes[1].box, beside.box);
    EXPECT_EQ(bvh.nodes[1].count, beside.count);
    expect_right_boxes(bvh, after);
  }
}

TEST(Refit, CountsWhatItHolds) {
  const Scene scene = test::scene_of(test::random_boxes(1000, 1));
  const Bvh2 bvh = test::random_tree(scene, 1);
  const std::size_t leaf_bits = 2000 / 8 + 6;  // whole words
  EXPECT_EQ(Refitter(bvh, scene.triangles, RefitMethod::serial, 1).bytes(), 1000 * sizeof(Triangle) + leaf_bits);
  EXPECT_EQ(Refitter(bvh, scene.triangles, RefitMethod::atomics, 1).bytes(), 1000 * (sizeof(Triangle) + 4 + 1) + leaf_bits);
}

}  // namespace
}  // namespace raystudy
