#include "harness/report/statistics.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace raystudy {
namespace {

using Interval = Estimate::Interval;

TEST(Median, IsTheMiddleOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(median_of(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median_of(std::vector<double>{4, 1, 3, 2}), 2.5);
  EXPECT_THROW((void)median_of({}), std::logic_error);
}

TEST(EstimateMedian, HasNoIntervalBelowThreeSamples) {
  const Estimate two = estimate_median(std::vector<double>{1, 3});
  EXPECT_EQ(two.value, 2);
  EXPECT_FALSE(two.interval);
}

// Of three, a resample's median is the least where the least is drawn twice or more: 7/27 of the resamples. So the 2.5th
// percentile is the least, and the 97.5th the greatest.
TEST(EstimateMedian, OfThreeSpansThemAll) {
  const Estimate three = estimate_median(std::vector<double>{5, 1, 2});
  EXPECT_EQ(three.value, 2);
  EXPECT_EQ(three.interval, (Interval{1, 5}));
}

// Of seven, the median is the least where that is drawn four times or more: P(Bin(7, 1/7) >= 4) = 1.0 %, below 2.5 %. It is one
// of the two least with P(Bin(7, 2/7) >= 4) = 10.8 %, above. So the interval runs from the second to the sixth.
TEST(EstimateMedian, OfSevenLeavesTheExtremesOut) {
  const Estimate seven = estimate_median(std::vector<double>{70, 10, 20, 60, 30, 50, 40});
  EXPECT_EQ(seven.value, 40);
  EXPECT_EQ(seven.interval, (Interval{20, 60}));
}

TEST(EstimateMedian, IsTheSameEachTime) {
  std::vector<double> samples;
  for (int i = 0; i < 20; ++i) samples.push_back((i * 37) % 101);
  EXPECT_EQ(estimate_median(samples).interval, estimate_median(samples).interval);
}

TEST(EstimateRatio, DividesMedians) {
  const Estimate constant = estimate_ratio(std::vector<double>{6, 6, 6}, std::vector<double>{4, 4, 4});
  EXPECT_EQ(constant.value, 1.5);
  EXPECT_EQ(constant.interval, (Interval{1.5, 1.5}));
  // Each extreme pair has (7/27)^2 = 6.7 % of the resamples: above 2.5 %.
  const Estimate spread = estimate_ratio(std::vector<double>{2, 4, 8}, std::vector<double>{1, 2, 4});
  EXPECT_EQ(spread.value, 2);
  EXPECT_EQ(spread.interval, (Interval{0.5, 8}));
  EXPECT_FALSE(estimate_ratio(std::vector<double>{2, 4, 8}, std::vector<double>{1, 2}).interval);
}

}  // namespace
}  // namespace raystudy
