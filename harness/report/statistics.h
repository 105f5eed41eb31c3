#pragma once

#include <optional>
#include <span>

namespace raystudy {

/// A central value and, where repetitions allow it, its 95 % confidence interval.
struct Estimate {
  double value = 0;
  struct Interval {
    double low = 0;
    double high = 0;
    friend bool operator==(const Interval&, const Interval&) = default;
  };
  std::optional<Interval> interval;
};

/// The median: the middle sample, or the mean of the middle two. Throws std::logic_error where there is no sample.
[[nodiscard]] double median_of(std::span<const double> samples);

/// The median of timed samples with the percentile bootstrap interval of the median (Efron and Tibshirani 1993, chapter 13):
/// 10,000 resamples from a fixed seed, between the 2.5th and the 97.5th percentile. No interval for fewer than 3 samples.
[[nodiscard]] Estimate estimate_median(std::span<const double> samples);

/// The ratio of the medians of two sets of timed samples. Both sets are resampled independently: interleaving is random, so that
/// a repetition of one has no partner in the other. No interval where either set has fewer than 3 samples.
[[nodiscard]] Estimate estimate_ratio(std::span<const double> numerator, std::span<const double> denominator);

}  // namespace raystudy
