#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "harness/accel/coverage.h"
#include "harness/accel/distinct_triangles.h"
#include "harness/accel/validate.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

/// The triangle (0, 0), (4, 0), (0, 4) in the plane z = 1.
const std::array<Vec3, 3> half_square{Vec3{0, 0, 1}, {4, 0, 1}, {0, 4, 1}};

Box flat(float x0, float y0, float x1, float y1) { return {{x0, y0, 1}, {x1, y1, 1}}; }

TEST(Coverage, OfOneBox) {
  EXPECT_TRUE(boxes_cover(std::array{flat(0, 0, 4, 4)}, half_square));
  EXPECT_FALSE(boxes_cover(std::array{flat(0, 0, 4, 3.9F)}, half_square));
  EXPECT_FALSE(boxes_cover(std::array{Box{{0, 0, 1.5F}, {4, 4, 2}}}, half_square));
  EXPECT_FALSE(boxes_cover({}, half_square));
}

// At x = 2 the triangle reaches y = 2: the part beyond it needs a box of that height only.
TEST(Coverage, OfTheTwoPartsOfASplit) {
  EXPECT_TRUE(boxes_cover(std::array{flat(0, 0, 2, 4), flat(2, 0, 4, 2)}, half_square));
  EXPECT_FALSE(boxes_cover(std::array{flat(0, 0, 2, 4), flat(2, 0, 4, 1.999F)}, half_square));
  EXPECT_FALSE(boxes_cover(std::array{flat(0, 0, 1.999F, 4), flat(2, 0, 4, 2)}, half_square)) << "a gap";
  EXPECT_TRUE(boxes_cover(std::array{flat(0, 0, 2.5F, 4), flat(2, 0, 4, 2)}, half_square)) << "an overlap";
}

TEST(Coverage, FindsAHoleBetweenFourBoxes) {
  const std::array around{flat(0, 0, 4, 1), flat(0, 2, 4, 4), flat(0, 0, 0.5F, 4), flat(0.75F, 0, 4, 4)};
  EXPECT_FALSE(boxes_cover(around, half_square));
  std::vector<Box> all(around.begin(), around.end());
  all.push_back(flat(0.5F, 1, 0.75F, 2));
  EXPECT_TRUE(boxes_cover(all, half_square));
}

TEST(Coverage, OfTrianglesWithoutArea) {
  const std::array<Vec3, 3> segment{Vec3{0, 0, 0}, {1, 1, 1}, {4, 4, 4}};
  const Box first{{0, 0, 0}, {2, 2, 2}};
  EXPECT_TRUE(boxes_cover(std::array{first, Box{{2, 2, 2}, {4, 4, 4}}}, segment));
  EXPECT_FALSE(boxes_cover(std::array{first, Box{{2.001F, 2, 2}, {4, 4, 4}}}, segment));
  const std::array<Vec3, 3> point{Vec3{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
  EXPECT_TRUE(boxes_cover(std::array{Box{{1, 2, 3}, {1, 2, 3}}}, point));
  EXPECT_FALSE(boxes_cover(std::array{first}, point));
}

// The triangle cut into a grid, each cell with the smallest box around it in exact arithmetic: coordinates are multiples of 1/8.
TEST(Coverage, OfAGridNeedsEachOfItsCells) {
  std::vector<Box> cells;
  for (int i = 0; i < 32; ++i) {
    for (int j = 0; i + j < 32; ++j) {
      const auto x = static_cast<float>(i) / 8;
      const auto y = static_cast<float>(j) / 8;
      cells.push_back(flat(x, y, x + 0.125F, y + 0.125F));
    }
  }
  std::shuffle(cells.begin(), cells.end(), std::mt19937(1));
  EXPECT_TRUE(boxes_cover(cells, half_square));
  for (std::size_t i = 0; i < cells.size(); i += 17) {
    std::vector<Box> fewer = cells;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
    EXPECT_FALSE(boxes_cover(fewer, half_square)) << i;
  }
}

/// Triangle 0 is half_square, cut at x = 2; triangle 1 stands apart.
struct CutScene {
  Scene scene;
  Bvh2 bvh;

  CutScene() {
    scene.vertices = SharedArray<Vec3>({half_square[0], half_square[1], half_square[2], {8, 0, 1}, {9, 0, 1}, {8, 1, 1}});
    scene.triangles = SharedArray<Triangle>({Triangle{{0, 1, 2}}, Triangle{{3, 4, 5}}});
    bvh.nodes.resize(6);
    bvh.nodes[2] = {flat(0, 0, 2, 4), 0, 1};
    bvh.nodes[4] = {flat(2, 0, 4, 2), 1, 1};
    bvh.nodes[5] = {flat(8, 0, 9, 1), 2, 1};
    bvh.triangles = {0, 0, 1};
    bvh.duplicates = true;
    unite();
  }
  void unite() {
    bvh.nodes[3] = {united(bvh.nodes[4].box, bvh.nodes[5].box), 4, 0};
    bvh.nodes[0] = {united(bvh.nodes[2].box, bvh.nodes[3].box), 2, 0};
  }
};

TEST(Validation, TakesTheClippedPartsOfATriangle) {
  CutScene cut;
  EXPECT_THAT(find_problems(cut.bvh, cut.scene), testing::IsEmpty());
  cut.bvh.duplicates = false;
  EXPECT_THAT(find_problems(cut.bvh, cut.scene),
              testing::UnorderedElementsAre("leaf 2 does not contain triangle 0", "leaf 4 does not contain triangle 0",
                                            "triangle 0 is in 2 leaves"));
}

TEST(Validation, OfDuplicatesFindsWhatIsWrong) {
  CutScene short_box;
  short_box.bvh.nodes[4].box.upper.y = 1.5F;
  short_box.unite();
  EXPECT_THAT(find_problems(short_box.bvh, short_box.scene),
              testing::ElementsAre("triangle 0 is not covered by the boxes of the 2 leaves that it is in"));
  CutScene one_part;
  one_part.bvh.triangles = {1, 0, 1};
  EXPECT_THAT(find_problems(one_part.bvh, one_part.scene), testing::ElementsAre("leaf 2 does not meet triangle 1"));
  one_part.bvh.nodes[2].box.upper.x = 9;
  one_part.unite();
  EXPECT_THAT(find_problems(one_part.bvh, one_part.scene),
              testing::ElementsAre("triangle 0 is not covered by the boxes of the 1 leaves that it is in"));
  CutScene twice;
  twice.bvh.nodes[4].count = 2;
  twice.bvh.nodes[5].first = 3;
  twice.bvh.triangles = {0, 0, 0, 1};
  EXPECT_THAT(find_problems(twice.bvh, twice.scene), testing::ElementsAre("leaf 4 refers to triangle 0 twice"));
  CutScene lost;
  lost.bvh.triangles = {0, 0, 0};
  EXPECT_THAT(find_problems(lost.bvh, lost.scene),
              testing::ElementsAre("leaf 5 does not meet triangle 0", "triangle 1 is in 0 leaves"));
}

TEST(DistinctTriangles, OfASmallTree) {
  const CutScene cut;
  EXPECT_THAT(distinct_triangles(cut.bvh), testing::ElementsAre(2, 0, 1, 2, 1, 1));
  EXPECT_THAT(distinct_triangles(Bvh2{}), testing::IsEmpty());
}

/// What is under a node, by a set.
std::size_t counted(const Bvh2& bvh, std::uint32_t root) {
  std::set<std::uint32_t> seen;
  std::vector<std::uint32_t> stack{root};
  while (!stack.empty()) {
    const Bvh2Node& node = bvh.nodes[stack.back()];
    stack.pop_back();
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) seen.insert(bvh.triangles[i]);
    if (!node.is_leaf()) stack.insert(stack.end(), {node.first, node.first + 1});
  }
  return seen.size();
}

TEST(DistinctTriangles, OfRandomTreesAreThoseOfASet) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(200, seed));
    Bvh2 bvh = test::random_tree(scene, seed, 1);
    for (std::uint32_t& triangle : bvh.triangles) triangle = triangle * 7 % (20 * static_cast<std::uint32_t>(seed));
    bvh.duplicates = true;
    const std::vector<std::uint32_t> counts = distinct_triangles(bvh);
    for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
      if (i == 1) continue;
      ASSERT_EQ(counts[i], counted(bvh, i)) << "node " << i << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace raystudy
