#pragma once

#include <optional>
#include <span>
#include <vector>

#include "harness/report/table.h"
#include "harness/report/value.h"

namespace raystudy {

/// What a method takes for n rays in all: build + n · per_ray, in seconds.
struct TotalTime {
  double build = 0;
  double per_ray = 0;
};

/// Numbers of rays, from the first up to the last; an infinite last one: all from there on.
struct RayRange {
  double first = 0;
  double last = 0;
};

/// For each of `times` the numbers of rays, from 0, for which it is the least: the lower envelope of the lines. Nothing where it
/// never is; of equal ones the first counts.
[[nodiscard]] std::vector<std::optional<RayRange>> fastest_ranges(std::span<const TotalTime> times);

/// The cells of a column of the quantity break_even: of medians of total_time and trace_rate, among the methods at `places`. A
/// method that is never the fastest is absent as "never".
[[nodiscard]] std::vector<ReportCell> break_even_cells(const std::vector<ValuePlace>& places, const ResultSet& results);

}  // namespace raystudy
