#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>

#include "harness/accel/validate.h"
#include "tests/support/wide_trees.h"

namespace raystudy {
namespace {

using test::HandMade;
using testing::ElementsAre;
using testing::IsEmpty;

template <class Node>
class WideValidation : public testing::Test {};

using NodeTypes = testing::Types<WideNode<4>, WideNode<8>, WideNode<16>, QuantizedNode<4>, QuantizedNode<8>, QuantizedNode<16>>;
TYPED_TEST_SUITE(WideValidation, NodeTypes);

TYPED_TEST(WideValidation, OfAValidTree) {
  const HandMade<TypeParam> made;
  EXPECT_THAT(find_problems(made.bvh, made.scene), IsEmpty());
  EXPECT_THAT(find_structural_problems(made.bvh, made.scene.triangles.size()), IsEmpty());
  EXPECT_THAT(find_problems(static_cast<const Accel&>(made.bvh), made.scene), IsEmpty());
  EXPECT_THAT(find_problems(WideBvh(), Scene()), IsEmpty());
}

TYPED_TEST(WideValidation, OfSizes) {
  const HandMade<TypeParam> made;
  EXPECT_THAT(find_problems(WideBvh(), made.scene), ElementsAre("the tree is empty but the scene has 6 triangles"));
  WideBvh bvh = made.bvh;
  bvh.corners.pop_back();
  EXPECT_THAT(find_problems(bvh, made.scene), ElementsAre("69 floats of corners instead of 70"));
  bvh = made.bvh;
  std::get<WideBvh::NodeArray<TypeParam>>(bvh.nodes).clear();
  EXPECT_THAT(find_problems(bvh, made.scene), ElementsAre("no nodes over 6 triangle references"));
  bvh = WideBvh();
  bvh.height = 1;
  EXPECT_THAT(find_problems(bvh, Scene()), ElementsAre("the tree has no triangles but nodes, corners, bounds or a height"));
}

TYPED_TEST(WideValidation, OfSlots) {
  HandMade<TypeParam> late;
  late.node(0).child[3] = WideChild::leaf(5, 1);
  late.node(0).child[2] = WideChild::none;
  EXPECT_THAT(find_problems(late.bvh, late.scene), testing::Contains("slot 3 of node 0 is used after an empty one"));
  HandMade<TypeParam> none;
  none.node(1).child.fill(WideChild::none);
  EXPECT_THAT(find_problems(none.bvh, none.scene, 1), ElementsAre("node 1 has no children"));
  HandMade<TypeParam> outside;
  outside.node(0).child[0] = 2;
  EXPECT_THAT(find_problems(outside.bvh, outside.scene, 1), ElementsAre("slot 0 of node 0 refers to node 2, not one in [1, 2)"));
  HandMade<TypeParam> cycle;
  cycle.node(1).child[0] = 0;
  EXPECT_THAT(find_problems(cycle.bvh, cycle.scene, 1), ElementsAre("slot 0 of node 1 refers to node 0, not one in [1, 2)"));
  HandMade<TypeParam> twice;
  twice.node(1).child[0] = 1;
  EXPECT_THAT(find_problems(twice.bvh, twice.scene, 1), ElementsAre("node 1 has two parents, one of them 1"));
  HandMade<TypeParam> lost;
  lost.node(0).child[0] = WideChild::leaf(0, 3);
  EXPECT_THAT(find_problems(lost.bvh, lost.scene),
              testing::IsSupersetOf({"node 1 has no parent", "the height is 2; the longest way has 1 nodes"}));
}

TYPED_TEST(WideValidation, OfLeaves) {
  HandMade<TypeParam> past;
  past.node(0).child[2] = WideChild::leaf(5, 2);
  EXPECT_THAT(find_problems(past.bvh, past.scene, 1), ElementsAre("leaf 2 of node 0 ends at 7, past the 6 triangle references"));
  HandMade<TypeParam> gap;
  gap.node(0).child[1] = WideChild::leaf(3, 1);
  EXPECT_THAT(find_problems(gap.bvh, gap.scene),
              testing::IsSupersetOf({"triangle reference 4 is in no leaf", "triangle 4 is in 0 leaves"}));
  HandMade<TypeParam> shared;
  shared.node(0).child[2] = WideChild::leaf(4, 1);
  EXPECT_THAT(find_problems(shared.bvh, shared.scene),
              testing::Contains("leaf 2 of node 0 shares triangle references with another"));
  HandMade<TypeParam> range;
  range.bvh.triangles[5] = 6;
  EXPECT_THAT(find_problems(range.bvh, range.scene),
              ElementsAre("leaf 2 of node 0 refers to triangle 6 of 6", "triangle 5 is in 0 leaves"));
  HandMade<TypeParam> repeated;
  repeated.bvh.triangles[4] = 3;
  EXPECT_THAT(
      find_problems(repeated.bvh, repeated.scene),
      ElementsAre("leaf 1 of node 0 refers to triangle 3 twice", "the corners in leaf 1 of node 0 are not those of triangle 3",
                  "triangle 3 is in 2 leaves", "triangle 4 is in 0 leaves"));
}

TYPED_TEST(WideValidation, OfCorners) {
  HandMade<TypeParam> made;
  made.bvh.corners[WideBvh::row(0, 2, 0, 0) + 1] = 1.5F;  // triangle 1, a.x
  EXPECT_THAT(find_problems(made.bvh, made.scene), ElementsAre("the corners in leaf 0 of node 1 are not those of triangle 1"));
  EXPECT_THAT(find_structural_problems(made.bvh, made.scene.triangles.size()), IsEmpty());
  HandMade<TypeParam> zero;
  float& a_x = zero.bvh.corners[WideBvh::row(0, 2, 0, 0)];
  ASSERT_EQ(a_x, 0);
  a_x = -0.0F;
  EXPECT_THAT(find_problems(zero.bvh, zero.scene), ElementsAre("the corners in leaf 0 of node 1 are not those of triangle 0"));
}

TYPED_TEST(WideValidation, OfHeightAndBounds) {
  HandMade<TypeParam> made;
  made.bvh.height = 3;
  made.bvh.bounds.upper.x = 7;
  EXPECT_THAT(find_problems(made.bvh, made.scene), testing::IsSupersetOf({"the height is 3; the longest way has 2 nodes"}));
  made.bvh.bounds.upper.x = 300;
  EXPECT_THAT(find_problems(made.bvh, made.scene), testing::Contains("the bounds are not those of the root's boxes"));
}

TYPED_TEST(WideValidation, OfBoxesThatDoNotHoldTheirTriangles) {
  HandMade<TypeParam> leaf;
  leaf.set_box(0, 2, {{10, 0, 0}, {10.0F, 1, 1}});
  EXPECT_THAT(find_problems(leaf.bvh, leaf.scene), testing::Contains("leaf 2 of node 0 does not contain triangle 5"));
  // The box of the way is too small, those of the leaves are not.
  HandMade<TypeParam> way;
  way.set_box(0, 0, {{0, 0, 0}, {4, 1, 1}});
  const std::string expected = way.quantized ? "leaf 1 of node 1 does not contain triangle 2"
                                             : "the box of slot 1 of node 1 is not inside that of its parent";
  EXPECT_THAT(find_problems(way.bvh, way.scene), ElementsAre(expected));
}

/// Triangle 5 again, whole, in the leaf of triangles 0 and 1, in place of 1, whose box it does not meet.
TYPED_TEST(WideValidation, OfDuplicates) {
  HandMade<TypeParam> made;
  made.bvh.duplicates = true;
  EXPECT_THAT(find_problems(made.bvh, made.scene), IsEmpty());
  made.bvh.triangles[1] = 5;
  EXPECT_THAT(find_problems(made.bvh, made.scene),
              ElementsAre("leaf 0 of node 1 does not meet triangle 5",
                          "the corners in leaf 0 of node 1 are not those of triangle 5", "triangle 1 is in 0 leaves"));
  HandMade<TypeParam> part;
  part.bvh.duplicates = true;
  part.set_box(0, 2, {{10, 0, 0}, {10, 1, 1}});
  part.bvh.bounds.upper.x = 10;
  EXPECT_THAT(find_problems(part.bvh, part.scene),
              ElementsAre("triangle 5 is not covered by the boxes of the 1 leaves that it is in"));
}

TYPED_TEST(WideValidation, OfOrders) {
  HandMade<TypeParam> made;
  std::swap(made.node(1).order[2][0], made.node(1).order[2][3]);
  EXPECT_THAT(find_problems(made.bvh, made.scene), IsEmpty());
  made.node(1).order[2][1] = 0;
  EXPECT_THAT(find_problems(made.bvh, made.scene), ElementsAre("row 2 of the orders of node 1 does not hold every slot once"));
}

TEST(WideValidationOfFloats, OfEmptyAndInfiniteBoxes) {
  HandMade<WideNode<4>> filled;
  filled.node(1).bounds[2][1][3] = 1;
  EXPECT_THAT(find_problems(filled.bvh, filled.scene), ElementsAre("the box of the empty slot 3 of node 1 is not empty"));
  for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -1.0F}) {
    HandMade<WideNode<4>> made;
    made.node(1).bounds[0][1][0] = bad;
    EXPECT_THAT(find_problems(made.bvh, made.scene), testing::Contains("the box of slot 0 of node 1 is empty or not finite"));
  }
}

TEST(WideValidationOf8Bits, OfGrids) {
  HandMade<QuantizedNode<4>> used;
  used.node(1).exponent[3] = 3;
  EXPECT_THAT(find_problems(used.bvh, used.scene, 1), ElementsAre("node 1 says that 3 slots are used, not 2"));
  HandMade<QuantizedNode<4>> fine;
  fine.node(1).exponent[1] = -127;
  EXPECT_THAT(find_problems(fine.bvh, fine.scene, 1), ElementsAre("the grid of node 1 is not finite, or finer than 2^-126"));
  HandMade<QuantizedNode<4>> origin;
  origin.node(1).origin[2] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(find_problems(origin.bvh, origin.scene, 1), ElementsAre("the grid of node 1 is not finite, or finer than 2^-126"));
}

}  // namespace
}  // namespace raystudy
