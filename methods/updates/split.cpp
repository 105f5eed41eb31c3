#include "methods/updates/split.h"

#include <algorithm>
#include <limits>

namespace raystudy::updates {
namespace {

constexpr double not_allowed = std::numeric_limits<double>::infinity();

}  // namespace

PartCosts::PartCosts(std::size_t segments, const std::function<double(std::size_t, std::size_t)>& cost)
    : segments_(segments), costs_((segments + 1) * (segments + 1), not_allowed) {
  for (std::size_t begin = 0; begin < segments; ++begin) {
    for (std::size_t end = begin + 1; end <= segments; ++end) costs_[begin * (segments + 1) + end] = cost(begin, end);
  }
}

std::vector<std::size_t> cheapest_split(const PartCosts& costs, std::size_t count) {
  const std::size_t n = costs.segments();
  if (count == 0 || count > n) return {};
  // least[k][end]: of k + 1 parts over the first `end` segments; last[k][end]: where the last of them begins.
  std::vector least(count, std::vector<double>(n + 1, not_allowed));
  std::vector last(count, std::vector<std::size_t>(n + 1, 0));
  for (std::size_t end = 1; end <= n; ++end) least[0][end] = costs.of(0, end);
  for (std::size_t k = 1; k < count; ++k) {
    for (std::size_t end = k + 1; end <= n; ++end) {
      for (std::size_t begin = k; begin < end; ++begin) {
        const double cost = least[k - 1][begin] + costs.of(begin, end);
        if (!(cost < least[k][end])) continue;
        least[k][end] = cost;
        last[k][end] = begin;
      }
    }
  }
  if (!(least[count - 1][n] < not_allowed)) return {};
  std::vector<std::size_t> begins(count);
  std::size_t end = n;
  for (std::size_t k = count; k-- > 0;) end = begins[k] = last[k][end];
  return begins;
}

std::vector<std::size_t> fewest_parts(const PartCosts& costs) {
  for (std::size_t count = 1; count <= costs.segments(); ++count) {
    std::vector<std::size_t> begins = cheapest_split(costs, count);
    if (!begins.empty()) return begins;
  }
  return {};
}

std::vector<std::size_t> equal_parts(std::size_t total, std::size_t count) {
  std::vector<std::size_t> begins(count);
  for (std::size_t i = 0; i < count; ++i) begins[i] = i * total / count;
  return begins;
}

}  // namespace raystudy::updates
