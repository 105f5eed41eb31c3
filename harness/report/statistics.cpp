#include "harness/report/statistics.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <stdexcept>
#include <vector>

namespace raystudy {
namespace {

constexpr std::size_t resamples = 10'000;
constexpr std::size_t fewest_samples = 3;
constexpr std::uint64_t bootstrap_seed = 20150601;

double median_in_place(std::vector<double>& samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return (*std::max_element(samples.begin(), middle) + *middle) / 2;
}

/// Medians of resamples with replacement. std::uniform_int_distribution is not the same on every machine; this is.
class Bootstrap {
 public:
  explicit Bootstrap(std::span<const double> samples) : samples_(samples), drawn_(samples.size()) {}
  double next(std::mt19937_64& random) {
    for (double& d : drawn_) d = samples_[((random() >> 32U) * samples_.size()) >> 32U];
    return median_in_place(drawn_);
  }

 private:
  std::span<const double> samples_;
  std::vector<double> drawn_;
};

/// Between the 2.5th and the 97.5th percentile, counted inwards from both ends alike.
Estimate::Interval percentiles(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  const std::size_t cut = values.size() / 40;
  return {values[cut], values[values.size() - 1 - cut]};
}

}  // namespace

double median_of(std::span<const double> samples) {
  if (samples.empty()) throw std::logic_error("median of no samples");
  std::vector<double> copy(samples.begin(), samples.end());
  return median_in_place(copy);
}

Estimate estimate_median(std::span<const double> samples) {
  Estimate estimate{median_of(samples), {}};
  if (samples.size() < fewest_samples) return estimate;
  std::mt19937_64 random(bootstrap_seed);
  Bootstrap bootstrap(samples);
  std::vector<double> medians(resamples);
  for (double& m : medians) m = bootstrap.next(random);
  estimate.interval = percentiles(medians);
  return estimate;
}

Estimate estimate_ratio(std::span<const double> numerator, std::span<const double> denominator) {
  Estimate estimate{median_of(numerator) / median_of(denominator), {}};
  if (std::min(numerator.size(), denominator.size()) < fewest_samples) return estimate;
  std::mt19937_64 random(bootstrap_seed);
  Bootstrap above(numerator);
  Bootstrap below(denominator);
  std::vector<double> ratios(resamples);
  for (double& r : ratios) {
    const double top = above.next(random);
    r = top / below.next(random);
  }
  estimate.interval = percentiles(ratios);
  return estimate;
}

}  // namespace raystudy
