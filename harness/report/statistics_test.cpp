#include "harness/report/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
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

Estimate median(const std::vector<double>& samples) { return Bootstrapped::median(samples, 1).estimate(); }

Bootstrapped ratio(const Bootstrapped& a, const Bootstrapped& b) {
  const std::vector<const Bootstrapped*> inputs{&a, &b};
  return Bootstrapped::combined(inputs, [](std::span<const double> x) { return x[0] / x[1]; });
}

TEST(Bootstrap, HasNoIntervalBelowThreeSamples) {
  const Estimate two = median({1, 3});
  EXPECT_EQ(two.value, 2);
  EXPECT_FALSE(two.interval);
}

// Of three, a resample's median is the least where the least is drawn twice or more: 7/27 of the resamples. So the 2.5th
// percentile is the least, and the 97.5th the greatest.
TEST(Bootstrap, OfThreeSpansThemAll) {
  const Estimate three = median({5, 1, 2});
  EXPECT_EQ(three.value, 2);
  EXPECT_EQ(three.interval, (Interval{1, 5}));
}

// Of seven, the median is the least where that is drawn four times or more: P(Bin(7, 1/7) >= 4) = 1.0 %, below 2.5 %. It is one
// of the two least with P(Bin(7, 2/7) >= 4) = 10.8 %, above. So the interval runs from the second to the sixth.
TEST(Bootstrap, OfSevenLeavesTheExtremesOut) {
  const Estimate seven = median({70, 10, 20, 60, 30, 50, 40});
  EXPECT_EQ(seven.value, 40);
  EXPECT_EQ(seven.interval, (Interval{20, 60}));
}

TEST(Bootstrap, DependsOnItsSeedAlone) {
  std::vector<double> samples;
  samples.reserve(20);
  for (int i = 0; i < 20; ++i) samples.push_back((i * 37) % 101);
  EXPECT_EQ(Bootstrapped::median(samples, 7).replicates, Bootstrapped::median(samples, 7).replicates);
  EXPECT_NE(Bootstrapped::median(samples, 7).replicates, Bootstrapped::median(samples, 8).replicates);
}

TEST(Bootstrap, OfARatioDrawsBothSides) {
  const Bootstrapped six = Bootstrapped::median(std::vector<double>{6, 6, 6}, 1);
  const Bootstrapped four = Bootstrapped::median(std::vector<double>{4, 4, 4}, 2);
  EXPECT_EQ(ratio(six, four).estimate().value, 1.5);
  EXPECT_EQ(ratio(six, four).estimate().interval, (Interval{1.5, 1.5}));
  // Each extreme pair has (7/27)^2 = 6.7 % of the resamples: above 2.5 %.
  const Bootstrapped a = Bootstrapped::median(std::vector<double>{2, 4, 8}, 1);
  const Bootstrapped b = Bootstrapped::median(std::vector<double>{1, 2, 4}, 2);
  EXPECT_EQ(ratio(a, b).estimate().value, 2);
  EXPECT_EQ(ratio(a, b).estimate().interval, (Interval{0.5, 8}));
  EXPECT_EQ(ratio(a, a).estimate().interval, (Interval{1, 1})) << "a value has the same replicate wherever it is used";
}

TEST(Bootstrap, OfExactValuesIsExact) {
  const Bootstrapped exact = ratio(Bootstrapped::constant(3), Bootstrapped::constant(4));
  EXPECT_TRUE(exact.exact);
  EXPECT_EQ(exact.value, 0.75);
  EXPECT_FALSE(exact.estimate().interval);
  const Bootstrapped mixed = ratio(Bootstrapped::median(std::vector<double>{2, 4, 8}, 1), Bootstrapped::constant(2));
  EXPECT_FALSE(mixed.exact);
  EXPECT_EQ(mixed.estimate().interval, (Interval{1, 4}));
  EXPECT_FALSE(ratio(Bootstrapped::median(std::vector<double>{2, 4}, 1), Bootstrapped::median(std::vector<double>{2, 4, 8}, 1))
                   .estimate()
                   .interval);
}

TEST(FitPower, TheSlopeOfTheLeastSquaresLine) {
  // Logarithms of base 4: x = 0, 1, 2; y = 0, 1.5, 2. Slope 1, residuals -1/6, 1/3, -1/6: their squares' sum is 1/6, xx is 2.
  const std::vector<double> sizes{1, 4, 16};
  const std::vector<double> values{1, 8, 16};
  const PowerFit fit = fit_power(sizes, values).value();
  EXPECT_NEAR(fit.exponent, 1, 1e-12);
  EXPECT_NEAR(fit.standard_error.value(), std::sqrt(1.0 / 12), 1e-12);
}

TEST(FitPower, AnExactPowerHasNoError) {
  const std::vector<double> sizes{10, 100, 1000, 10000};
  const std::vector<double> values{3, 3e2, 3e4, 3e6};
  EXPECT_NEAR(fit_power(sizes, values)->exponent, 2, 1e-12);
  EXPECT_NEAR(fit_power(sizes, values)->standard_error.value(), 0, 1e-6);
}

TEST(FitPower, NeedsTwoSizesAndThreePointsForAnError) {
  EXPECT_FALSE(fit_power(std::vector<double>{}, std::vector<double>{}));
  EXPECT_FALSE(fit_power(std::vector<double>{7, 7}, std::vector<double>{1, 2}));
  const std::vector<double> two{1, 2};
  EXPECT_NEAR(fit_power(two, std::vector<double>{4, 8})->exponent, 1, 1e-12);
  EXPECT_FALSE(fit_power(two, std::vector<double>{4, 8})->standard_error);
  EXPECT_THROW((void)fit_power(two, std::vector<double>{0, 1}), std::logic_error);
  EXPECT_THROW((void)fit_power(two, std::vector<double>{1}), std::logic_error);
}

}  // namespace
}  // namespace raystudy
