#include "harness/geometry/morton.h"

#include <gtest/gtest.h>

#include <limits>

namespace raystudy {
namespace {

TEST(Morton, CodeByHand) {
  EXPECT_EQ(morton_code(0, 0, 0), 0U);
  EXPECT_EQ(morton_code(1, 0, 0), 4U);
  EXPECT_EQ(morton_code(0, 1, 0), 2U);
  EXPECT_EQ(morton_code(0, 0, 1), 1U);
  EXPECT_EQ(morton_code(0b10, 0b01, 0b11), 0b101'011U);
  EXPECT_EQ(morton_code(0x1fffff, 0x1fffff, 0x1fffff), (std::uint64_t{1} << 63U) - 1);
}

TEST(Morton, SpreadsEveryBit) {
  for (unsigned bit = 0; bit < 21; ++bit) EXPECT_EQ(spread_bits(std::uint64_t{1} << bit), std::uint64_t{1} << (3 * bit)) << bit;
  EXPECT_EQ(spread_bits(std::uint64_t{1} << 21U), 0U);
}

TEST(Morton, GridCellsAreHalfOpenAndTheLastIsClosed) {
  const MortonGrid grid({{0, -2, 10}, {4, 2, 10}}, 2);  // cells of 1; flat along z
  EXPECT_EQ(grid.code({0, -2, 10}), morton_code(0, 0, 0));
  EXPECT_EQ(grid.code({0.99F, -1, 10}), morton_code(0, 1, 0));
  EXPECT_EQ(grid.code({1, 1.5F, 10}), morton_code(1, 3, 0));
  EXPECT_EQ(grid.code({4, 2, 10}), morton_code(3, 3, 0));
  EXPECT_EQ(grid.code({-7, 9, 11}), morton_code(0, 3, 0));  // outside: the nearest
}

TEST(Morton, GridOfTheLargestBoxesAndOfAPoint) {
  constexpr float most = std::numeric_limits<float>::max();
  const MortonGrid huge({Vec3{-most}, Vec3{most}}, 21);
  EXPECT_EQ(huge.code(Vec3{-most}), 0U);
  EXPECT_EQ(huge.code(Vec3{most}), morton_code(0x1fffff, 0x1fffff, 0x1fffff));
  EXPECT_EQ(huge.code(Vec3{0}), morton_code(1U << 20U, 1U << 20U, 1U << 20U));
  constexpr float least = std::numeric_limits<float>::denorm_min();
  const MortonGrid tiny({Vec3{0}, Vec3{4 * least}}, 2);
  EXPECT_EQ(tiny.code({least, 2 * least, 3 * least}), morton_code(1, 2, 3));
  EXPECT_EQ(MortonGrid({Vec3{3}, Vec3{3}}, 10).code(Vec3{3}), 0U);
}

}  // namespace
}  // namespace raystudy
