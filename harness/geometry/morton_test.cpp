#include "harness/geometry/morton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cfenv>
#include <cmath>
#include <limits>
#include <random>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

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
  EXPECT_EQ(MortonGrid({Vec3{-0x1p127F}, Vec3{0x1p127F}}, 21).code(Vec3{0}), morton_code(1U << 20U, 1U << 20U, 1U << 20U));
  EXPECT_EQ(MortonGrid({Vec3{-most}, Vec3{most}}, 2).code({-most, most, -most / 4}), morton_code(0, 3, 1));
  EXPECT_EQ(MortonGrid({Vec3{3}, Vec3{3}}, 10).code(Vec3{3}), 0U);
  EXPECT_EQ(MortonGrid::center({Vec3{most}, Vec3{most}}), Vec3{most});
}

TEST(Morton, AxesTooShortForNormalFloatsHaveOneCell) {
  constexpr float short_axis = 0x1.fffffep-76F;  // half of it is less than 2^-76
  const MortonGrid grid({Vec3{0}, {0x1p-75F, short_axis, std::numeric_limits<float>::denorm_min()}}, 2);
  EXPECT_EQ(grid.code({0x1p-76F, short_axis, std::numeric_limits<float>::denorm_min()}), morton_code(2, 0, 0));
}

TEST(Morton, WhatIsNoNumberIsInTheFirstCellAndInfiniteBoxesHaveOne) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(MortonGrid({Vec3{0}, Vec3{1}}, 10).code({nan, infinity, -infinity}), morton_code(0, 1023, 0));
  const MortonGrid grid({{0, -infinity, nan}, {infinity, infinity, 1}}, 10);
  EXPECT_EQ(grid.code({1, 1, 1}), 0U);
  EXPECT_EQ(grid.code({infinity, infinity, nan}), 0U);
  EXPECT_EQ(MortonGrid(Box{}, 10).code(Vec3{1}), 0U);
}

class MortonCells : public testing::Test {
 protected:
  /// Of any magnitude, denormal ones included.
  float number() {
    for (;;) {
      const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(random_()));
      if (std::isfinite(x)) return x;
    }
  }
  /// Somewhere in [lower, upper], also close to the ends.
  float between(float lower, float upper) {
    const auto t = std::ldexp(static_cast<float>(random_() >> 40U), -24 - static_cast<int>(random_() % 40));
    const float x =
        random_() % 2 == 0 ? lower + (0.5F * upper - 0.5F * lower) * 2 * t : upper - (0.5F * upper - 0.5F * lower) * 2 * t;
    return std::clamp(x, lower, upper);
  }

  std::mt19937_64 random_{7};
};

/// The definition with the division rounded by the processor.
std::uint32_t cell_by_rounded_division(float lo, float hi, int bits, float c) {
  const float h = 0.5F * hi - 0.5F * lo;
  if (h < 0x1p-76F) return 0;
  const volatile float cells = std::ldexp(1.0F, bits);
  const volatile float divisor = h;
  const int mode = std::fegetround();
  std::fesetround(FE_TOWARDZERO);
  const volatile float scale = cells / divisor;
  std::fesetround(mode);
  const float place = (0.5F * c - 0.5F * lo) * scale;
  return std::min(static_cast<std::uint32_t>(place), (1U << static_cast<unsigned>(bits)) - 1);
}

TEST_F(MortonCells, AreThoseOfADivisionRoundedTowardZero) {
  for (int i = 0; i < 200000; ++i) {
    const auto [lo, hi] = std::minmax({number(), number()});
    const int bits = 2 + i % 20;
    const float c = between(lo, hi);
    const std::uint32_t cell = cell_by_rounded_division(lo, hi, bits, c);
    ASSERT_EQ(MortonGrid({Vec3{lo}, Vec3{hi}}, bits).code(Vec3{c}), morton_code(cell, cell, cell)) << lo << ' ' << hi << ' ' << c;
  }
}

TEST_F(MortonCells, DoNotDecreaseAlongAnAxis) {
  for (int i = 0; i < 200000; ++i) {
    const auto [lo, hi] = std::minmax({number(), number()});
    const auto [a, b] = std::minmax({between(lo, hi), between(lo, hi)});
    const MortonGrid grid({Vec3{lo}, Vec3{hi}}, 21);
    ASSERT_LE(grid.code({a, lo, lo}), grid.code({b, lo, lo})) << lo << ' ' << hi << ": " << a << ' ' << b;
  }
}

#if defined(__SSE2__)
TEST_F(MortonCells, DoNotDependOnDenormalNumbers) {
  const unsigned mode = _mm_getcsr();
  const auto small = [&] { return std::ldexp(number(), -static_cast<int>(random_() % 130)); };
  for (int i = 0; i < 200000; ++i) {
    // Extents about the least that has more than one cell, and centers at the bounds of cells but for a denormal number.
    const float lo = (random_() % 2 == 0 ? 0.F : small()) - std::ldexp(0x1p-97F, static_cast<int>(random_() % 20));
    const float hi = lo + std::ldexp(0x1p-76F, static_cast<int>(random_() % 4));
    const float c = lo + std::ldexp(static_cast<float>(random_() % 4), -97 + static_cast<int>(random_() % 3)) +
                    std::bit_cast<float>(static_cast<std::uint32_t>(random_() % 0x800000U)) * (random_() % 2 == 0 ? 1.F : -1.F);
    const std::uint64_t code = MortonGrid({Vec3{lo}, Vec3{hi}}, 21).code(Vec3{c});
    constexpr unsigned flush = 0x8040U;  // results and operands
    _mm_setcsr(mode | flush);
    const std::uint64_t flushed = MortonGrid({Vec3{lo}, Vec3{hi}}, 21).code(Vec3{c});
    _mm_setcsr(mode);
    ASSERT_EQ(code, flushed) << lo << ' ' << hi << ' ' << c;
  }
}
#endif

}  // namespace
}  // namespace raystudy
