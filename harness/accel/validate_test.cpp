#include "harness/accel/validate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/trees.h"

namespace raystudy {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

/// Three triangles in a row along x: a root with the leaf {0}, in slot 2, and in slot 3 a node with the leaves {1} and {2}.
class ValidationOfABvh2 : public testing::Test {
 protected:
  ValidationOfABvh2() {
    bvh_.nodes.resize(6);
    bvh_.triangles = {0, 1, 2};
    bvh_.nodes[2] = {boxes_[0], 0, 1};
    bvh_.nodes[4] = {boxes_[1], 1, 1};
    bvh_.nodes[5] = {boxes_[2], 2, 1};
    bvh_.nodes[3] = {united(boxes_[1], boxes_[2]), 4, 0};
    bvh_.nodes[0] = {united(bvh_.nodes[2].box, bvh_.nodes[3].box), 2, 0};
  }

  std::vector<Box> boxes_{{{0, 0, 0}, {1, 1, 1}}, {{2, 0, 0}, {3, 1, 1}}, {{4, 0, 0}, {5, 1, 1}}};
  Scene scene_ = test::scene_of(boxes_);
  Bvh2 bvh_;
};

TEST_F(ValidationOfABvh2, FindsNothingWhereNothingIsWrong) {
  EXPECT_THAT(find_problems(bvh_, scene_), IsEmpty());
  EXPECT_THAT(find_problems(static_cast<const Accel&>(bvh_), scene_), IsEmpty());
  EXPECT_THAT(find_structural_problems(bvh_, 3), IsEmpty());
  EXPECT_THAT(find_problems(Bvh2(), Scene()), IsEmpty());
}

TEST_F(ValidationOfABvh2, OfSizes) {
  EXPECT_THAT(find_problems(Bvh2(), scene_), ElementsAre("the tree is empty but the scene has 3 triangles"));
  bvh_.nodes.emplace_back();
  EXPECT_THAT(find_problems(bvh_, scene_), ElementsAre("7 node slots, which is odd", "node slot 6 is not used"));
  EXPECT_THAT(find_structural_problems(bvh_, 4), Contains("triangle 3 is in 0 leaves"));
}

TEST_F(ValidationOfABvh2, OfLinks) {
  bvh_.nodes[3].first = 6;
  EXPECT_THAT(find_problems(bvh_, scene_, 1), ElementsAre("inner node 3 has its children at 6, not an even slot in [2, 6)"));
  bvh_.nodes[3].first = 3;
  EXPECT_THAT(find_problems(bvh_, scene_, 1), ElementsAre("inner node 3 has its children at 3, not an even slot in [2, 6)"));
  bvh_.nodes[3].first = 0xffffffff;
  EXPECT_THAT(find_problems(bvh_, scene_, 1),
              ElementsAre("inner node 3 has its children at 4294967295, not an even slot in [2, 6)"));
  bvh_.nodes[3].first = 2;
  EXPECT_THAT(find_problems(bvh_, scene_, 1), ElementsAre("node 2 has two parents, one of them 3"));
}

TEST_F(ValidationOfABvh2, OfLeaves) {
  bvh_.nodes[5].first = 3;
  EXPECT_THAT(find_problems(bvh_, scene_, 1), ElementsAre("leaf 5 ends at 4, past the 3 triangle references"));
  bvh_.nodes[5] = {united(boxes_[1], boxes_[2]), 1, 2};
  EXPECT_THAT(find_problems(bvh_, scene_, 1), ElementsAre("leaf 2 shares some of the 3 triangle references with others"));
}

TEST_F(ValidationOfABvh2, OfBoxes) {
  bvh_.nodes[3].box.upper.x = 6;
  EXPECT_THAT(find_problems(bvh_, scene_), ElementsAre("the box of inner node 0 is not the union of its children's",
                                                       "the box of inner node 3 is not the union of its children's"));
  EXPECT_EQ(find_structural_problems(bvh_, 3).size(), 2U);
}

TEST_F(ValidationOfABvh2, OfTriangles) {
  bvh_.triangles[2] = 1;
  EXPECT_THAT(find_problems(bvh_, scene_),
              ElementsAre("leaf 5 does not contain triangle 1", "triangle 1 is in 2 leaves", "triangle 2 is in 0 leaves"));
  EXPECT_THAT(find_structural_problems(bvh_, 3), ElementsAre("triangle 1 is in 2 leaves", "triangle 2 is in 0 leaves"));
  bvh_.triangles[2] = 3;
  EXPECT_THAT(find_problems(bvh_, scene_), ElementsAre("leaf 5 refers to triangle 3 of 3", "triangle 2 is in 0 leaves"));
}

}  // namespace
}  // namespace raystudy
