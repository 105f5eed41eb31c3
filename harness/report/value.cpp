#include "harness/report/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "harness/spec/formula.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

/// The samples of one side of a value, or why there are none.
struct Found {
  const CellResult* cell = nullptr;
  const Measurement* measurement = nullptr;
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

Found find_samples(const std::string& metric, const ValuePlace& place, const ResultSet& results, bool is_baseline) {
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
  const auto value = found.cell->values.find(metric);
  if (value == found.cell->values.end() || value->second.samples.empty()) {
    found.absence = "none";
    found.reason = fmt::format("this method has no '{}'", metric);  // without the place: one note serves all such rows
    return found;
  }
  found.measurement = &value->second;
  return found;
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
  static const std::array<std::string, 7> keys{"cpu", "microcode", "kernel", "threads", "compiler", "flags", "commit"};
  for (const std::string& key : keys) {
    const std::string of_a = provenance_of(a, key);
    const std::string of_b = provenance_of(b, key);
    if (of_a != of_b) return fmt::format("{}: {} and {}", key, of_a, of_b);
  }
  return {};
}

FoundValue find_value(const ColumnSpec& column, const ValuePlace& place, std::string_view unit, const ResultSet& results) {
  const Found own = find_samples(column.metric, place, results, false);
  if (own.measurement == nullptr) return absent(own.absence, own.reason);
  FoundValue value;
  value.value_class = own.measurement->value_class;
  if (value.value_class != ValueClass::exact) value.timed_results.push_back(own.cell);
  if (column.relative_to.empty()) {
    value.value = sampled(own, column.metric, factor_to(column, own.measurement->unit, unit));
    return value;
  }
  ValuePlace base_place = place;
  base_place.method = column.relative_to;
  const Found base = find_samples(column.metric, base_place, results, true);
  if (base.measurement == nullptr) return absent(base.absence, base.reason);
  if (base.measurement->value_class != ValueClass::exact) value.timed_results.push_back(base.cell);
  if (!value.timed_results.empty()) value.value_class = ValueClass::ratio;
  if (!share_a_machine(value)) return value;
  const double factor = factor_to(column, own.measurement->unit, base.measurement->unit) * factor_to(column, "", unit);
  const Bootstrapped numerator = sampled(own, column.metric, 1);
  const Bootstrapped denominator = sampled(base, column.metric, 1);
  const std::array<const Bootstrapped*, 2> inputs{&numerator, &denominator};
  value.value = Bootstrapped::combined(inputs, [factor](std::span<const double> x) { return x[0] / x[1] * factor; });
  refuse_what_is_not_finite(value, fmt::format("'{}' of '{}' is 0", column.metric, column.relative_to));
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
