#include "harness/report/value.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "harness/spec/formula.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

/// The samples of one side of a value, or why there are none.
struct Found {
  const CellResult* cell = nullptr;
  std::optional<Measurement> measurement;
  std::string absence;
  std::string reason;
};

std::string described(const ValuePlace& place) {
  std::string text = fmt::format("{}, {}", place.scene, place.method);
  if (!place.tracer.empty()) text += ", " + place.tracer;
  if (!place.workload.empty()) text += ", " + place.workload;
  return text;
}

/// Why a result that is not `done` has no value. A missing scene is one thing, whatever the method.
void explain(Found& found, const CellResult& cell, const ValuePlace& place) {
  if (cell.status == CellStatus::missing) {
    found.absence = "not installed";
    found.reason = cell.reason;  // names the scene
  } else {
    found.absence = "failed";
    found.reason = fmt::format("{}: {}", described(place), cell.reason);
  }
}

/// The one tracer that `method` has been traced with: where its own is asked for, or a baseline lacks the one asked for.
const CellResult* with_its_only_tracer(const ResultSet& results, const ValuePlace& place) {
  const CellResult* only = nullptr;
  for (const CellResult& cell : results.all()) {
    if (cell.scene != place.scene || cell.method != place.method || cell.workload != place.workload || cell.tracer.empty()) {
      continue;
    }
    if (only != nullptr) return nullptr;
    only = &cell;
  }
  return only;
}

const Series* series_of(const CellResult& cell, const std::string& name) {
  const auto found = cell.series.find(name);
  return found == cell.series.end() || found->second.x.empty() ? nullptr : &found->second;
}

/// What the series is at `x`: its last sample up to there.
Measurement read_at(const Series& series, double x) {
  const auto after = std::upper_bound(series.x.begin(), series.x.end(), x) - series.x.begin();
  return {ValueClass::absolute, series.unit, {series.y[static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - 1, 0))]}};
}

/// One number of a series: at a place on its axis, or the place where it is first as low as another method's ends.
void read_series(Found& found, const ColumnSpec& column, const ValuePlace& place, const ResultSet& results) {
  const Series* series = series_of(*found.cell, column.metric);
  if (series == nullptr) return;
  if (!column.at.empty()) {
    found.measurement = read_at(*series, column.at.at(place.scene));
    return;
  }
  const CellResult* goal_cell = results.find(place.scene, column.until);
  const Series* goal = goal_cell == nullptr ? nullptr : series_of(*goal_cell, column.metric);
  if (goal == nullptr) {
    found.absence = "none";
    found.reason = fmt::format("{} has no '{}' to come down to", column.until, column.metric);
    return;
  }
  if (goal->y.back() >= goal->y.front()) {
    found.absence = "none";
    found.reason = fmt::format("{} ends no lower than it begins, with {:.4g}", column.until, goal->y.front());
    return;
  }
  const auto reached = std::find_if(series->y.begin(), series->y.end(), [&](double y) { return y <= goal->y.back(); });
  if (reached == series->y.end()) {
    found.absence = "not reached";
    found.reason = fmt::format("the {:.4g} that {} ends with; {} ends with {:.4g}", goal->y.back(), column.until, place.method,
                               series->y.back());
    return;
  }
  const double x = series->x[static_cast<std::size_t>(reached - series->y.begin())];
  found.measurement = Measurement{ValueClass::absolute, series->x_unit, {x}};
}

Found find_samples(const ColumnSpec& column, const ValuePlace& place, const ResultSet& results, bool is_baseline) {
  Found found;
  if (place.tracer != own_tracer) found.cell = results.find(place.scene, place.method, place.tracer, place.workload);
  if (found.cell == nullptr && (is_baseline || place.tracer == own_tracer) && !place.workload.empty()) {
    found.cell = with_its_only_tracer(results, place);
  }
  if (found.cell == nullptr) {
    // A build that failed takes its traced cells with it.
    const CellResult* build = place.workload.empty() ? nullptr : results.find(place.scene, place.method);
    if (build != nullptr && build->status != CellStatus::done) {
      explain(found, *build, {place.scene, place.method, {}, {}});
    } else {
      found.absence = "not run";
    }
    return found;
  }
  if (found.cell->status != CellStatus::done) {
    explain(found, *found.cell, place);
    return found;
  }
  if (!column.at.empty() || !column.until.empty()) {
    read_series(found, column, place, results);
  } else if (const auto value = found.cell->values.find(column.metric);
             value != found.cell->values.end() && !value->second.samples.empty()) {
    found.measurement = value->second;
  }
  if (!found.measurement && found.absence.empty()) {
    found.absence = "none";
    found.reason = fmt::format("this method has no '{}'", column.metric);  // without the place: one note serves all such rows
  }
  return found;
}

/// The best of `methods` by its median, or why none has a value. A method of several that has none is named in the reason.
Found find_best(const ColumnSpec& column, const std::vector<std::string>& methods, ValuePlace place, const ResultSet& results,
                bool is_baseline) {
  Found best;
  std::vector<std::string> without;
  for (const std::string& method : methods) {
    place.method = method;
    Found found = find_samples(column, place, results, is_baseline);
    if (!found.measurement && methods.size() > 1) without.push_back(fmt::format("{} ({})", method, found.absence));
    const auto is_better = [&] {
      const double own = found.measurement->median();
      const double other = best.measurement->median();
      return column.higher_is_better ? own > other : own < other;
    };
    const bool first = best.absence.empty() && !best.measurement;
    if (first || (found.measurement && (!best.measurement || is_better()))) best = std::move(found);
  }
  if (best.measurement && !without.empty()) best.reason = fmt::format("without {}", fmt::join(without, ", "));
  return best;
}

double factor_to(const ColumnSpec& column, std::string_view from, std::string_view to) {
  if (const auto factor = unit_factor(from, to)) return *factor;
  const auto named = [](std::string_view unit) {
    return unit.empty() || unit == "1" ? std::string("a pure number") : fmt::format("in '{}'", unit);
  };
  throw Error(Diagnostic{column.where,
                         fmt::format("column '{}' is shown {}, but its value is {}", column.name,
                                     to.empty() || to == "1" ? "as " + named(to) : named(to), named(from)),
                         "a unit of the same kind",
                         {}});
}

/// Values that are combined draw their resamples independently, and the same on every machine (FNV-1a).
std::uint64_t seed_of(const CellResult& cell, std::string_view metric) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const std::string_view text : {std::string_view(cell.scene), std::string_view(cell.method), std::string_view(cell.tracer),
                                      std::string_view(cell.workload), metric}) {
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    hash = (hash ^ 0xffU) * 0x100000001b3U;
  }
  return hash;
}

Bootstrapped sampled(const Found& found, std::string_view metric, double factor) {
  const Measurement& m = *found.measurement;
  if (m.value_class == ValueClass::exact) return Bootstrapped::constant(m.median() * factor);
  std::vector<double> samples = m.samples;
  for (double& sample : samples) sample *= factor;
  return Bootstrapped::median(samples, seed_of(*found.cell, metric));
}

FoundValue absent(std::string absence, std::string reason) {
  FoundValue value;
  value.absence = std::move(absence);
  value.reason = std::move(reason);
  return value;
}

std::string provenance_of(const CellResult& cell, const std::string& key) {
  const auto found = cell.provenance.find(key);
  return found == cell.provenance.end() ? "" : found->second;
}

/// Checks that times which are set against each other come from one machine. False, with the reason, where they do not.
bool share_a_machine(FoundValue& value) {
  for (const CellResult* other : value.timed_results) {
    const CellResult& first = *value.timed_results.front();
    if (const std::string difference = machine_difference(first, *other); !difference.empty()) {
      value = absent("none", fmt::format("times of different machines have no ratio: {}", difference));
      return false;
    }
    if (provenance_of(first, "timing_group") != provenance_of(*other, "timing_group")) {
      value.reason = "measured in different runs, not interleaved";
    }
  }
  return true;
}

void refuse_what_is_not_finite(FoundValue& value, const std::string& reason) {
  if (value.value && !std::isfinite(value.value->value)) value = absent("none", reason);
}

}  // namespace

std::string machine_difference(const CellResult& a, const CellResult& b) {
  static const std::array<std::string, 6> keys{"cpu", "microcode", "kernel", "compiler", "flags", "commit"};
  for (const std::string& key : keys) {
    const std::string of_a = provenance_of(a, key);
    const std::string of_b = provenance_of(b, key);
    if (of_a != of_b) return fmt::format("{}: {} and {}", key, of_a, of_b);
  }
  return {};
}

FoundValue find_value(const ColumnSpec& column, const ValuePlace& place, std::string_view unit, const ResultSet& results) {
  if (!column.at.empty() && !column.at.contains(place.scene)) return absent("none", "");
  const std::vector<std::string> methods = column.methods.empty() ? std::vector{place.method} : column.methods;
  const Found own = find_best(column, methods, place, results, false);
  if (!own.measurement) return absent(own.absence, own.reason);
  FoundValue value;
  value.value_class = own.measurement->value_class;
  if (value.value_class != ValueClass::exact) value.timed_results.push_back(own.cell);
  if (column.relative_to.empty()) {
    value.value = sampled(own, column.metric, factor_to(column, own.measurement->unit, unit));
    value.reason = joined(methods.size() > 1 ? own.cell->method : "", own.reason);
    return value;
  }
  const Found base = find_best(column, column.relative_to, place, results, true);
  if (!base.measurement) return absent(base.absence, base.reason);
  if (base.measurement->value_class != ValueClass::exact) value.timed_results.push_back(base.cell);
  if (!value.timed_results.empty()) value.value_class = ValueClass::ratio;
  if (!share_a_machine(value)) return value;
  const double factor = factor_to(column, own.measurement->unit, base.measurement->unit) * factor_to(column, "", unit);
  const Bootstrapped numerator = sampled(own, column.metric, 1);
  const Bootstrapped denominator = sampled(base, column.metric, 1);
  const std::array<const Bootstrapped*, 2> inputs{&numerator, &denominator};
  value.value = Bootstrapped::combined(inputs, [factor](std::span<const double> x) { return x[0] / x[1] * factor; });
  if (methods.size() > 1 || column.relative_to.size() > 1) {
    value.reason = joined(fmt::format("{} / {}", own.cell->method, base.cell->method), value.reason);
  }
  value.reason = joined(joined(value.reason, own.reason), base.reason);
  refuse_what_is_not_finite(value, fmt::format("'{}' of '{}' is 0", column.metric, base.cell->method));
  return value;
}

FoundValue find_formula(const ColumnSpec& column, const std::vector<ColumnSpec>& columns, const std::vector<FoundValue>& values,
                        std::string_view unit) {
  const Formula formula(column.formula);
  FoundValue value;
  std::vector<const Bootstrapped*> inputs;
  std::vector<const CellResult*>& timed = value.timed_results;
  for (const std::string& name : formula.names()) {
    const auto named = std::find_if(columns.begin(), columns.end(), [&](const ColumnSpec& c) { return c.name == name; });
    const auto index = static_cast<std::size_t>(named - columns.begin());
    if (index >= values.size()) {
      throw Error(Diagnostic{column.where,
                             fmt::format("formula of column '{}' names '{}'", column.name, name),
                             "the name of a column before it",
                             {}});
    }
    const FoundValue& input = values[index];
    if (!input.value) return absent(input.absence, input.reason);
    inputs.push_back(&*input.value);
    timed.insert(timed.end(), input.timed_results.begin(), input.timed_results.end());
  }
  if (!timed.empty()) value.value_class = unit_factor(unit, "") ? ValueClass::ratio : ValueClass::absolute;
  if (!share_a_machine(value)) return value;
  const std::vector<std::string>& names = formula.names();
  value.value = Bootstrapped::combined(inputs, [&](std::span<const double> x) {
    return formula.evaluate([&](std::string_view name) {
      return x[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
    });
  });
  refuse_what_is_not_finite(value, fmt::format("'{}' divides by 0", column.formula));
  return value;
}

}  // namespace raystudy
