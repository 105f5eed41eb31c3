#include "harness/report/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <set>
#include <stdexcept>

namespace raystudy {
namespace {

constexpr std::size_t fewest_samples = 3;

double median_in_place(std::vector<double>& samples) {
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  if (samples.size() % 2 == 1) return *middle;
  return (*std::max_element(samples.begin(), middle) + *middle) / 2;
}

}  // namespace

double median_of(std::span<const double> samples) {
  if (samples.empty()) throw std::logic_error("median of no samples");
  std::vector<double> copy(samples.begin(), samples.end());
  return median_in_place(copy);
}

Bootstrapped Bootstrapped::constant(double value) { return {value, true, {}}; }

Bootstrapped Bootstrapped::median(std::span<const double> samples, std::uint64_t seed) {
  Bootstrapped result{median_of(samples), false, {}};
  if (samples.size() < fewest_samples) return result;
  std::mt19937_64 random(seed);
  std::vector<double> drawn(samples.size());
  result.replicates.resize(replicate_count);
  for (double& replicate : result.replicates) {
    // std::uniform_int_distribution is not the same on every machine; this is.
    for (double& d : drawn) d = samples[((random() >> 32U) * samples.size()) >> 32U];
    replicate = median_in_place(drawn);
  }
  return result;
}

Bootstrapped Bootstrapped::combined(std::span<const Bootstrapped* const> inputs,
                                    const std::function<double(std::span<const double>)>& f) {
  std::vector<double> arguments;
  for (const Bootstrapped* input : inputs) arguments.push_back(input->value);
  Bootstrapped result{f(arguments), true, {}};
  bool replicated = true;
  for (const Bootstrapped* input : inputs) {
    result.exact = result.exact && input->exact;
    replicated = replicated && (input->exact || !input->replicates.empty());
  }
  if (result.exact || !replicated) return result;
  result.replicates.resize(replicate_count);
  for (std::size_t r = 0; r < replicate_count; ++r) {
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      if (!inputs[i]->exact) arguments[i] = inputs[i]->replicates[r];
    }
    result.replicates[r] = f(arguments);
  }
  return result;
}

Estimate Bootstrapped::estimate() const {
  Estimate result{value, {}};
  if (replicates.empty()) return result;
  std::vector<double> sorted = replicates;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t cut = sorted.size() / 40;
  result.interval = Estimate::Interval{sorted[cut], sorted[sorted.size() - 1 - cut]};
  return result;
}

std::optional<PowerFit> fit_power(std::span<const double> sizes, std::span<const double> values) {
  const std::size_t count = sizes.size();
  if (count != values.size()) throw std::logic_error("as many values as sizes are needed");
  const auto logarithm = [](double number) {
    if (!(number > 0)) throw std::logic_error("a power is fitted to numbers above 0");
    return std::log(number);
  };
  double x_mean = 0;
  double y_mean = 0;
  for (std::size_t i = 0; i < count; ++i) {
    x_mean += logarithm(sizes[i]) / static_cast<double>(count);
    y_mean += logarithm(values[i]) / static_cast<double>(count);
  }
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = std::log(sizes[i]) - x_mean;
    const double y = std::log(values[i]) - y_mean;
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  if (std::set<double>(sizes.begin(), sizes.end()).size() < 2) return std::nullopt;
  PowerFit fit{xy / xx, {}};
  if (count > 2) {
    const double residual = std::max(0.0, yy - fit.exponent * xy);
    fit.standard_error = std::sqrt(residual / static_cast<double>(count - 2) / xx);
  }
  return fit;
}

}  // namespace raystudy
