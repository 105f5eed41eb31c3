#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace raystudy::updates {

/// What each run of neighbouring segments of an animation would cost with one tree.
class PartCosts {
 public:
  /// Asks cost(begin, end) for every 0 <= begin < end <= segments, in that order; infinity: not allowed.
  PartCosts(std::size_t segments, const std::function<double(std::size_t begin, std::size_t end)>& cost);

  [[nodiscard]] std::size_t segments() const { return segments_; }
  [[nodiscard]] double of(std::size_t begin, std::size_t end) const { return costs_[begin * (segments_ + 1) + end]; }

 private:
  std::size_t segments_;
  std::vector<double> costs_;
};

/// Where the parts of the cheapest split into exactly `count` parts begin (0 first), by dynamic programming; of equal ones that
/// whose last part begins first, and so on. Empty where every such split has a part that is not allowed.
[[nodiscard]] std::vector<std::size_t> cheapest_split(const PartCosts& costs, std::size_t count);

/// The same for the least number of parts with which a split is allowed; empty where there is none.
[[nodiscard]] std::vector<std::size_t> fewest_parts(const PartCosts& costs);

/// Where `count` parts of [0, total) begin that are as equal as whole numbers let them be, the longer ones last; count <= total.
/// 100 in 3 gives 0, 33, 66 (Bittner and Meister 2015, Fig. 5).
[[nodiscard]] std::vector<std::size_t> equal_parts(std::size_t total, std::size_t count);

}  // namespace raystudy::updates
