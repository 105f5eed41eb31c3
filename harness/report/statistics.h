#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

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

/// A value with what it would have been had the repetitions been drawn again: the bootstrap's replicates, `replicate_count` of
/// them. An exact value has none and counts as a constant.
struct Bootstrapped {
  static constexpr std::size_t replicate_count = 10'000;
  double value = 0;
  bool exact = true;
  std::vector<double> replicates;  ///< empty where exact, or where there are too few samples to tell

  [[nodiscard]] static Bootstrapped constant(double value);
  /// The median of timed samples with the medians of resamples with replacement. Fewer than 3 samples have no replicates. Values
  /// that are combined need seeds of their own: random interleaving gives a repetition of one method no partner among another's,
  /// so that they are drawn independently.
  [[nodiscard]] static Bootstrapped median(std::span<const double> samples, std::uint64_t seed);
  /// f of the values, and of each replicate of them. No replicates where one of the inputs that are not exact has none.
  [[nodiscard]] static Bootstrapped combined(std::span<const Bootstrapped* const> inputs,
                                             const std::function<double(std::span<const double>)>& f);

  /// The value between the 2.5th and the 97.5th percentile of its replicates: the percentile interval (Efron and Tibshirani, An
  /// Introduction to the Bootstrap, 1993, chapter 13).
  [[nodiscard]] Estimate estimate() const;
};

/// values ~ sizes^exponent: the least-squares line through the logarithms of both.
struct PowerFit {
  double exponent = 0;
  std::optional<double> standard_error;  ///< of the exponent; needs three points
};
/// Nothing where there are no two different sizes. Throws std::logic_error for a number that is not above 0.
[[nodiscard]] std::optional<PowerFit> fit_power(std::span<const double> sizes, std::span<const double> values);

}  // namespace raystudy
