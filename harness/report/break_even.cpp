#include "harness/report/break_even.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace raystudy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The number of rays from which on `later` is faster than `now`; infinite where it never is.
double crossing(const TotalTime& now, const TotalTime& later) {
  return later.per_ray < now.per_ray ? (later.build - now.build) / (now.per_ray - later.per_ray) : infinity;
}

FoundValue found(const char* metric, const char* unit, const ValuePlace& place, const ResultSet& results) {
  ColumnSpec column;
  column.name = column.metric = metric;
  return find_value(column, place, unit, results);
}

}  // namespace

std::vector<std::optional<RayRange>> fastest_ranges(std::span<const TotalTime> times) {
  std::vector<std::optional<RayRange>> ranges(times.size());
  if (times.empty()) return ranges;
  std::size_t now = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const bool is_sooner = times[i].build < times[now].build;
    if (is_sooner || (times[i].build == times[now].build && times[i].per_ray < times[now].per_ray)) now = i;
  }
  for (double rays = 0;;) {
    double end = infinity;
    std::size_t next = now;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double meeting = crossing(times[now], times[i]);
      if (meeting < end || (meeting == end && next != now && times[i].per_ray < times[next].per_ray)) {
        end = meeting;
        next = i;
      }
    }
    ranges[now] = RayRange{rays, end};
    if (next == now) return ranges;
    now = next;
    rays = end;
  }
}

std::vector<ReportCell> break_even_cells(const std::vector<ValuePlace>& places, const ResultSet& results) {
  std::vector<ReportCell> cells(places.size());
  std::vector<TotalTime> times;
  std::vector<std::size_t> compared;  // places with both times
  const CellResult* first = nullptr;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const FoundValue build = found("total_time", "s", {places[i].scene, places[i].method, {}, {}}, results);
    const FoundValue rate = found("trace_rate", "rays/s", places[i], results);
    const FoundValue& lacking = build.value ? rate : build;
    cells[i].absence = lacking.absence;
    cells[i].reason = lacking.reason;
    if (!build.value || !rate.value) continue;
    for (const FoundValue* value : {&build, &rate}) {
      for (const CellResult* result : value->timed_results) {
        if (first == nullptr) first = result;
        const std::string difference = machine_difference(*first, *result);
        if (!difference.empty()) cells[i].reason = fmt::format("times of different machines are not added: {}", difference);
      }
    }
    cells[i].absence = cells[i].reason.empty() ? "never" : "none";
    if (!cells[i].reason.empty()) continue;
    times.push_back({build.value->value, 1 / rate.value->value});
    compared.push_back(i);
  }
  const std::vector<std::optional<RayRange>> ranges = fastest_ranges(times);
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    if (!ranges[k]) continue;
    ReportCell& cell = cells[compared[k]];
    cell.value_class = ValueClass::absolute;
    cell.ours = Estimate{ranges[k]->first, {}};
    cell.range_end = ranges[k]->last;
    cell.absence.clear();
  }
  return cells;
}

}  // namespace raystudy
