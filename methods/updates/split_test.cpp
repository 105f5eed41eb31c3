#include "methods/updates/split.h"

#include <gmock/gmock.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <random>

namespace raystudy::updates {
namespace {

using testing::ElementsAre;
constexpr double not_allowed = std::numeric_limits<double>::infinity();

TEST(EqualParts, AreThePapersForAHundredFrames) {
  EXPECT_THAT(equal_parts(100, 3), ElementsAre(0, 33, 66));
  EXPECT_THAT(equal_parts(5, 5), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(equal_parts(5, 1), ElementsAre(0));
}

PartCosts random_costs(std::size_t segments, std::uint64_t seed, bool some_not_allowed) {
  std::mt19937_64 random(seed);
  return {segments, [&](std::size_t /*begin*/, std::size_t /*end*/) {
            const auto cost = static_cast<double>(random() % 1000);
            return some_not_allowed && random() % 3 == 0 ? not_allowed : cost;
          }};
}

double cost_of(const PartCosts& costs, const std::vector<std::size_t>& begins) {
  double sum = 0;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    sum += costs.of(begins[i], i + 1 < begins.size() ? begins[i + 1] : costs.segments());
  }
  return sum;
}

/// The least cost over all choices of borders; infinite where none is allowed.
double brute_force(const PartCosts& costs, std::size_t count) {
  double least = not_allowed;
  for (std::uint32_t borders = 0; borders < 1U << (costs.segments() - 1); ++borders) {
    if (static_cast<std::size_t>(std::popcount(borders)) + 1 != count) continue;
    std::vector<std::size_t> begins{0};
    for (std::size_t i = 1; i < costs.segments(); ++i) {
      if ((borders >> (i - 1) & 1U) != 0) begins.push_back(i);
    }
    least = std::min(least, cost_of(costs, begins));
  }
  return least;
}

TEST(CheapestSplit, IsTheBestOfAll) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::size_t segments = 1 + seed % 9;
    const PartCosts costs = random_costs(segments, seed, seed % 2 == 0);
    std::size_t fewest = 0;
    for (std::size_t count = 1; count <= segments; ++count) {
      const std::vector<std::size_t> begins = cheapest_split(costs, count);
      const double least = brute_force(costs, count);
      if (least == not_allowed) {
        EXPECT_THAT(begins, testing::IsEmpty());
        continue;
      }
      ASSERT_EQ(begins.size(), count);
      EXPECT_EQ(begins[0], 0U);
      EXPECT_EQ(cost_of(costs, begins), least);
      if (fewest == 0) fewest = count;
    }
    EXPECT_EQ(fewest_parts(costs).size(), fewest);
  }
}

TEST(CheapestSplit, HasNoMorePartsThanSegments) {
  const PartCosts costs = random_costs(3, 1, false);
  EXPECT_THAT(cheapest_split(costs, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(cheapest_split(costs, 4), testing::IsEmpty());
  EXPECT_THAT(cheapest_split(costs, 0), testing::IsEmpty());
}

}  // namespace
}  // namespace raystudy::updates
