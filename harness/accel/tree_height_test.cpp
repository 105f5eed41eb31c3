#include "harness/accel/tree_height.h"

#include <gtest/gtest.h>

namespace raystudy {
namespace {

TEST(TreeHeight, CountsTheLevelsBelowTheRoot) {
  Bvh2 bvh;
  EXPECT_EQ(tree_height(bvh), 0U);
  bvh.nodes = {{{}, 0, 1}, {}};
  EXPECT_EQ(tree_height(bvh), 0U);
  bvh.nodes = {{{}, 2, 0}, {}, {{}, 0, 1}, {{}, 4, 0}, {{}, 1, 1}, {{}, 2, 1}};
  EXPECT_EQ(tree_height(bvh), 2U);
}

}  // namespace
}  // namespace raystudy
