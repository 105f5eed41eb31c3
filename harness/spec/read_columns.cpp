#include "harness/spec/read_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/spec/formula.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

constexpr const char* target_expected = "a bound, such as '>= 1.15' or '< 77.3', or a map of scene to bound";

bool is_time_series(const Quantity& quantity) { return quantity.axis == "seconds"; }

}  // namespace

std::string ColumnReader::owner(const ColumnSpec& column) const { return fmt::format("{} '{}'", settings_.word, column.name); }

ColumnSpec ColumnReader::read_quantity(const YamlEntry& name) {
  ColumnSpec column;
  column.name = column.label = column.metric = name.key;
  column.where = name.where;
  complete_metric(column, name.where, {});
  return column;
}

ColumnSpec ColumnReader::read(const YamlEntry& entry, const std::vector<ColumnSpec>& before) {
  ColumnSpec column;
  column.name = entry.key;
  column.where = entry.where;
  const YamlNode& node = reading_.at_scale(*entry.value);
  if (node.is_scalar()) {  // `cost_sah: cost`
    column.label = entry.key;
    column.metric = node.text;
    complete_metric(column, node.where, {});
    return column;
  }
  Fields fields(reading_, node, owner(column));
  if (!fields.is_map()) return column;
  column.label = fields.text("label", entry.key);
  column.decimals = static_cast<int>(std::get<std::int64_t>(fields.value(integer_param("decimals", 2, "", 0, 15))));
  read_published(fields, column);
  read_targets(fields, column);
  const YamlNode* metric = fields.find("metric");
  const YamlNode* formula = fields.find("formula");
  if ((metric == nullptr) == (formula == nullptr)) {
    reading_.report(entry.where, fmt::format("{} has {}", owner(column), metric ? "both 'metric' and 'formula'" : "no 'metric'"),
                    "either 'metric' or 'formula'");
  }
  const YamlNode* unit = fields.find("unit");
  if (formula != nullptr) {
    column.unit = fields.text("unit");
    column.formula = fields.text("formula");
    check_formula(column, formula->where, before);
  } else {
    read_methods(fields, column);
    read_dimensions(fields, column);
    read_place_on_axis(fields, column);
  }
  if (formula == nullptr && metric != nullptr) {
    column.metric = fields.text("metric");
    complete_metric(column, metric->where,
                    unit == nullptr ? std::nullopt : std::optional(YamlEntry{fields.text("unit"), unit->where, nullptr}));
  }
  fields.finish();
  return column;
}

void ColumnReader::check_formula(const ColumnSpec& column, const SourceLocation& where, const std::vector<ColumnSpec>& before) {
  try {
    const Formula formula(column.formula);
    std::vector<std::string> known;
    known.reserve(before.size());
    for (const ColumnSpec& other : before) known.push_back(other.name);
    for (const std::string& name : formula.names()) {
      if (std::find(known.begin(), known.end(), name) != known.end()) continue;
      reading_.report_unknown(
          where, fmt::format("the formula of {} asks for '{}', which is no {} before it", owner(column), name, settings_.word),
          name, known);
    }
  } catch (const Error& error) {
    const Diagnostic& problem = error.diagnostics().front();
    reading_.report(where, problem.message, problem.expected);
  }
}

void ColumnReader::read_published(Fields& fields, ColumnSpec& column) {
  column.published = fields.text("published");
  if (column.published.empty() || !plan_.paper.empty()) return;
  reading_.report(fields.find("published")->where, fmt::format("{} names a published value", owner(column)),
                  "'paper' in the experiment, the name of a file in results/published");
}

/// The scenes that a key of a map over scenes stands for.
std::vector<std::string> ColumnReader::scenes_named(const YamlEntry& entry) const {
  return lookup_.all_of(plan_.scenes, {entry.key, entry.where, nullptr}, "scene");
}

/// One bound for all scenes, or a map with one for each scene that has any.
void ColumnReader::read_targets(Fields& fields, ColumnSpec& column) {
  const YamlNode* node = fields.find("target");
  if (node == nullptr) return;
  if (!column.published.empty()) {
    reading_.report(node->where, fmt::format("{} has both 'published' and 'target'", owner(column)),
                    "one of them: a value has one verdict");
  }
  const auto bound = [this](const YamlNode& written, const std::string& what) {
    std::optional<Target> target = written.is_scalar() ? parse_target(written.text) : std::nullopt;
    if (!target) reading_.report(written.where, fmt::format("{} is {}", what, described(written)), target_expected);
    return target;
  };
  if (!node->is_map()) {
    if (const std::optional<Target> target = bound(*node, "'target'")) {
      for (const SceneSpec& scene : plan_.scenes) column.targets[scene.label] = *target;
    }
    return;
  }
  for (const YamlEntry& entry : node->entries) {
    const std::optional<Target> target = bound(*entry.value, fmt::format("the target of '{}'", entry.key));
    for (const std::string& scene : scenes_named(entry)) {
      if (target) column.targets[scene] = *target;
    }
  }
}

/// One method, or each point of a sweep, by every name of a list.
std::vector<std::string> ColumnReader::method_list(const YamlNode& node, const std::string& key) {
  std::vector<std::string> methods;
  const std::size_t before = reading_.problems.size();
  for (const YamlEntry& name : read_names(reading_, node, fmt::format("'{}'", key))) {
    for (std::string& label : lookup_.all_of(plan_.pipelines, name, "method")) methods.push_back(std::move(label));
  }
  if (node.is_list() && node.items.empty()) {
    reading_.report(node.where, fmt::format("'{}' is empty", key), "at least one method");
  }
  if (reading_.problems.size() > before || methods.empty()) return {"?"};  // what is wrong has been said
  return methods;
}

void ColumnReader::read_methods(Fields& fields, ColumnSpec& column) {
  const YamlNode* method = fields.find("method");
  const YamlNode* best_of = fields.find("best_of");
  for (const auto& [node, key] : {std::pair{method, "method"}, {best_of, "best_of"}}) {
    if (node == nullptr || !settings_.by_method) continue;
    reading_.report(node->where,
                    fmt::format("'{}' stands in a table whose {} are methods", key,
                                std::string_view(settings_.word) == "row" ? "columns" : "rows"),
                    fmt::format("a {} without it", settings_.word));
  }
  if (method != nullptr && best_of != nullptr) {
    reading_.report(best_of->where, fmt::format("{} has both 'method' and 'best_of'", owner(column)), "one of them");
  }
  if (method != nullptr) {
    column.methods = {lookup_.one_of(plan_.pipelines, *method, "method").value_or("?")};
  } else if (best_of != nullptr) {
    column.methods = method_list(*best_of, "best_of");
  }
  if (const YamlNode* base = fields.find("relative_to")) {
    column.relative_to = base->is_list() ? method_list(*base, "relative_to")
                                         : std::vector{lookup_.one_of(plan_.pipelines, *base, "method").value_or("?")};
  }
}

void ColumnReader::read_dimensions(Fields& fields, ColumnSpec& column) {
  if (const YamlNode* tracer = fields.find("tracer")) {
    column.tracer = lookup_.tracer(*tracer).value_or("?");
  }
  if (const YamlNode* workload = fields.find("workload")) {
    column.workload = lookup_.one_of(plan_.workloads, *workload, "workload").value_or("?");
  }
}

/// `at`: a time, or a map of scene to time. `until`: a method.
void ColumnReader::read_place_on_axis(Fields& fields, ColumnSpec& column) {
  const YamlNode* at = fields.find("at");
  const YamlNode* until = fields.find("until");
  if (at != nullptr && until != nullptr) {
    reading_.report(until->where, fmt::format("{} has both 'at' and 'until'", owner(column)), "one of them");
  }
  if (until != nullptr) column.until = lookup_.one_of(plan_.pipelines, *until, "method").value_or("?");
  if (at != nullptr && at->is_map()) {
    Fields by_scene(reading_, *at, "'at'");
    for (const YamlEntry& entry : at->entries) {
      const double seconds = by_scene.quantity(entry.key, 0, time_units(), "29 ms");
      for (const std::string& scene : scenes_named(entry)) column.at[scene] = seconds;
    }
  } else if (at != nullptr) {
    const double seconds = fields.quantity("at", 0, time_units(), "29 ms");
    for (const SceneSpec& scene : plan_.scenes) column.at[scene.label] = seconds;
  }
}

/// The unit of the value before 'unit' has its say: of a series, of what 'at' or 'until' make of it.
std::string ColumnReader::natural_unit(const ColumnSpec& column, const Quantity& quantity, const SourceLocation& where) {
  const bool reads_series = !column.at.empty() || !column.until.empty();
  if (!quantity.axis.empty() && !(reads_series && is_time_series(quantity))) {
    reading_.report(where, fmt::format("'{}' is a series over {}", column.metric, quantity.axis),
                    is_time_series(quantity)
                        ? "'at' or 'until', which make one number of it; or a figure, which can draw it"
                        : fmt::format("a quantity of one number in a {}; a series can be drawn by a figure", settings_.word));
  }
  if (quantity.axis.empty() && reads_series) {
    reading_.report(
        where,
        fmt::format("{} has '{}', and '{}' is one number", owner(column), column.at.empty() ? "until" : "at", column.metric),
        "a series over time, such as cost_over_time");
  }
  if (!column.relative_to.empty()) return {};
  if (!column.until.empty()) return "s";
  return quantity.unit == "1" ? std::string{} : quantity.unit;
}

void ColumnReader::complete_metric(ColumnSpec& column, const SourceLocation& where, const std::optional<YamlEntry>& unit) {
  const std::optional<Quantity> quantity = lookup_.quantity(column.metric, where);
  if (!quantity) return;
  column.higher_is_better = quantity->higher_is_better;
  if (quantity->animated && !plan_.animation) {
    reading_.report(where, fmt::format("{} asks for '{}', and the experiment plays no animation", owner(column), column.metric),
                    "'animation: {frames: 50}' in the experiment");
  }
  check_break_even(column, where);
  const std::string natural = natural_unit(column, *quantity, where);
  column.unit = unit ? unit->key : natural;
  if (unit && !unit_factor(natural, unit->key)) {
    reading_.report(unit->where, fmt::format("{} cannot be shown in '{}'", owner(column), unit->key),
                    fmt::format("one of {}", fmt::join(units_for(natural.empty() ? "1" : natural), ", ")));
  }
  if (!settings_.by_method && column.methods.empty()) {
    column.methods = {lookup_.the_only(plan_.pipelines, where, owner(column), "method").value_or("?")};
  }
  complete_tracing(column, *quantity, where);
}

/// What is found by comparing a table's methods needs them, as they are.
void ColumnReader::check_break_even(const ColumnSpec& column, const SourceLocation& where) {
  if (column.metric != break_even_quantity) return;
  if (!settings_.by_method) {
    reading_.report(where,
                    fmt::format("'{}' compares the methods of a table, and this one's {} are scenes", column.metric,
                                std::string_view(settings_.word) == "row" ? "columns" : "rows"),
                    "a table of methods");
  }
  if (!column.relative_to.empty() || !column.targets.empty() || !column.published.empty()) {
    reading_.report(where, fmt::format("{} shows ranges, which are not compared", owner(column)),
                    "a " + std::string(settings_.word) + " without 'relative_to', 'target' and 'published'");
  }
}

void ColumnReader::complete_tracing(ColumnSpec& column, const Quantity& quantity, const SourceLocation& where) {
  if (!quantity.traced) {
    if (!column.tracer.empty() || !column.workload.empty()) {
      reading_.report(where, fmt::format("'{}' does not depend on rays", column.metric),
                      fmt::format("a {} without 'tracer' and 'workload'", settings_.word));
    }
    return;
  }
  if (column.tracer.empty()) {
    column.tracer =
        settings_.tracer ? *settings_.tracer : lookup_.the_only(plan_.tracers, where, owner(column), "tracer").value_or("?");
  }
  if (column.workload.empty()) {
    column.workload = settings_.workload ? *settings_.workload
                                         : lookup_.the_only(plan_.workloads, where, owner(column), "workload").value_or("?");
  }
  const std::string asks = owner(column) + " asks for";
  for (const std::string& method : column.methods) lookup_.check_traced(column.tracer, method, where, asks);
  for (const std::string& method : column.relative_to) lookup_.check_traced(column.tracer, method, where, asks);
}

}  // namespace raystudy
