#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "harness/method/registry.h"
#include "harness/spec/formula.h"
#include "harness/spec/lookup.h"
#include "harness/spec/quantity.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

class TableReader {
 public:
  TableReader(Reading& reading, const Plan& plan) : reading_(reading), plan_(plan), lookup_(reading, plan) {}

  TableSpec read(const YamlEntry& entry) {
    TableSpec table;
    table.name = entry.key;
    table.where = entry.where;
    Fields fields(reading_, *entry.value, fmt::format("table '{}'", entry.key));
    table.caption = fields.text("caption", entry.key);
    table.rows = std::get<std::string>(fields.value(choice_param("rows", {"scene", "method"}, "")));
    by_method_ = table.rows == "method";
    for (const YamlEntry& name : fields.names("only")) {
      const std::vector<std::string> labels =
          by_method_ ? lookup_.all_of(plan_.pipelines, name, "method") : lookup_.all_of(plan_.scenes, name, "scene");
      table.row_filter.insert(table.row_filter.end(), labels.begin(), labels.end());
    }
    if (const YamlNode* scene = fields.find("scene")) {
      if (!by_method_) reading_.report(scene->where, "'scene' stands in a table whose rows are scenes", "'only' to choose rows");
      table.scene = lookup_.one_of(plan_.scenes, *scene, "scene").value_or("");
    }
    if (const YamlNode* tracer = fields.find("tracer")) tracer_ = lookup_.one_of(plan_.tracers, *tracer, "tracer");
    if (const YamlNode* workload = fields.find("workload")) workload_ = lookup_.one_of(plan_.workloads, *workload, "workload");
    if (const YamlNode* columns = fields.require("columns", "a map of name to column, or a list of quantities")) {
      read_columns(*columns, table);
    }
    fields.finish();
    return table;
  }

 private:
  void read_columns(const YamlNode& node, TableSpec& table) {
    if (node.is_list()) {
      for (const YamlEntry& name : read_names(reading_, node, "'columns'")) {
        ColumnSpec column;
        column.name = column.label = column.metric = name.key;
        column.where = name.where;
        complete_metric(column, name.where, {});
        add(std::move(column), table);
      }
    } else if (node.is_map()) {
      for (const YamlEntry& entry : node.entries) add(read_column(entry, table), table);
    } else {
      reading_.report(node.where, fmt::format("'columns' is {}", described(node)),
                      "a map of name to column, or a list of quantities");
    }
    if ((node.is_list() && node.items.empty()) || (node.is_map() && node.entries.empty())) {
      reading_.report(node.where, "'columns' is empty", "at least one column");
    }
  }

  void add(ColumnSpec column, TableSpec& table) {
    if (!is_formula_name(column.name)) {
      reading_.report(column.where, fmt::format("the column's name is '{}'", column.name),
                      "letters, digits and '_', as formulas can hold it");
    }
    const auto same = [&column](const ColumnSpec& other) { return other.name == column.name; };
    if (std::any_of(table.columns.begin(), table.columns.end(), same)) {
      reading_.report(column.where, fmt::format("two columns are called '{}'", column.name), "each name once");
    }
    table.columns.push_back(std::move(column));
  }

  ColumnSpec read_column(const YamlEntry& entry, const TableSpec& table) {
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
    Fields fields(reading_, node, fmt::format("column '{}'", entry.key));
    if (!fields.is_map()) return column;
    column.label = fields.text("label", entry.key);
    column.decimals = static_cast<int>(std::get<std::int64_t>(fields.value(integer_param("decimals", 2, "", 0, 15))));
    column.published = fields.text("published");
    if (!column.published.empty() && plan_.paper.empty()) {
      reading_.report(fields.find("published")->where, fmt::format("column '{}' names a published value", entry.key),
                      "'paper' in the experiment, the name of a file in results/published");
    }
    const YamlNode* metric = fields.find("metric");
    const YamlNode* formula = fields.find("formula");
    if ((metric == nullptr) == (formula == nullptr)) {
      reading_.report(entry.where,
                      fmt::format("column '{}' has {}", entry.key, metric ? "both 'metric' and 'formula'" : "no 'metric'"),
                      "either 'metric' or 'formula'");
    }
    const YamlNode* unit = fields.find("unit");
    if (formula != nullptr) {
      column.unit = fields.text("unit");
      column.formula = fields.text("formula");
      check_formula(column, formula->where, table);
    } else {
      read_dimensions(fields, column);
    }
    if (formula == nullptr && metric != nullptr) {
      column.metric = fields.text("metric");
      complete_metric(column, metric->where,
                      unit == nullptr ? std::nullopt : std::optional(YamlEntry{fields.text("unit"), unit->where, nullptr}));
    }
    fields.finish();
    return column;
  }

  void check_formula(const ColumnSpec& column, const SourceLocation& where, const TableSpec& table) {
    try {
      const Formula formula(column.formula);
      std::vector<std::string> known;
      for (const ColumnSpec& before : table.columns) known.push_back(before.name);
      for (const std::string& name : formula.names()) {
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        reading_.report_unknown(
            where, fmt::format("the formula of column '{}' asks for '{}', which is no column before it", column.name, name), name,
            known);
      }
    } catch (const Error& error) {
      const Diagnostic& problem = error.diagnostics().front();
      reading_.report(where, problem.message, problem.expected);
    }
  }

  void read_dimensions(Fields& fields, ColumnSpec& column) {
    if (const YamlNode* method = fields.find("method")) {
      if (by_method_) reading_.report(method->where, "'method' stands in a table whose rows are methods", "a column without it");
      column.method = lookup_.one_of(plan_.pipelines, *method, "method").value_or("?");
    }
    if (const YamlNode* base = fields.find("relative_to")) {
      column.relative_to = lookup_.one_of(plan_.pipelines, *base, "method").value_or("?");
    }
    if (const YamlNode* tracer = fields.find("tracer")) {
      const bool own = by_method_ && tracer->is_scalar() && tracer->text == own_tracer;
      column.tracer = own ? own_tracer : lookup_.one_of(plan_.tracers, *tracer, "tracer").value_or("?");
    }
    if (const YamlNode* workload = fields.find("workload")) {
      column.workload = lookup_.one_of(plan_.workloads, *workload, "workload").value_or("?");
    }
  }

  /// Checks the quantity and fills in what the column leaves open and the table or the plan settles.
  void complete_metric(ColumnSpec& column, const SourceLocation& where, const std::optional<YamlEntry>& unit) {
    const std::optional<Quantity> quantity = lookup_.quantity(column.metric, where);
    if (!quantity) return;
    if (!quantity->axis.empty()) {
      reading_.report(where, fmt::format("'{}' is a series over {}", column.metric, quantity->axis),
                      "a quantity of one number in a column; a series can be drawn by a figure");
    }
    const bool is_pure = !column.relative_to.empty() || quantity->unit == "1";
    const std::string natural = is_pure ? std::string{} : quantity->unit;
    column.unit = unit ? unit->key : natural;
    if (unit && !unit_factor(natural, unit->key)) {
      reading_.report(unit->where, fmt::format("column '{}' cannot be shown in '{}'", column.name, unit->key),
                      fmt::format("one of {}", fmt::join(units_for(is_pure ? "1" : natural), ", ")));
    }
    if (!by_method_ && column.method.empty()) {
      column.method = lookup_.the_only(plan_.pipelines, where, fmt::format("column '{}'", column.name), "method").value_or("?");
    }
    complete_tracing(column, *quantity, where);
  }

  void complete_tracing(ColumnSpec& column, const Quantity& quantity, const SourceLocation& where) {
    if (!quantity.traced) {
      if (!column.tracer.empty() || !column.workload.empty()) {
        reading_.report(where, fmt::format("'{}' does not depend on rays", column.metric),
                        "a column without 'tracer' and 'workload'");
      }
      return;
    }
    const std::string owner = fmt::format("column '{}'", column.name);
    if (column.tracer.empty()) {
      column.tracer = tracer_ ? *tracer_ : lookup_.the_only(plan_.tracers, where, owner, "tracer").value_or("?");
    }
    if (column.workload.empty()) {
      column.workload = workload_ ? *workload_ : lookup_.the_only(plan_.workloads, where, owner, "workload").value_or("?");
    }
    for (const std::string& method : {column.method, column.relative_to}) {
      const auto pipeline = index_of(plan_.pipelines, method);
      if (!pipeline || !index_of(plan_.tracers, column.tracer)) continue;
      const std::vector<std::string>& tracers = plan_.pipelines[*pipeline].tracers;
      if (std::find(tracers.begin(), tracers.end(), column.tracer) != tracers.end()) continue;
      reading_.report(where,
                      fmt::format("{} asks for tracer '{}', which does not trace method '{}'", owner, column.tracer, method),
                      tracers.empty() ? "a method that is traced" : fmt::format("one of {}", fmt::join(tracers, ", ")));
    }
  }

  Reading& reading_;
  const Plan& plan_;
  Lookup lookup_;
  bool by_method_ = false;
  std::optional<std::string> tracer_;
  std::optional<std::string> workload_;
};

}  // namespace

void read_tables(Reading& reading, const YamlNode& node, Plan& plan) {
  if (!node.is_map()) {
    reading.report(node.where, fmt::format("'tables' is {}", described(node)), "a map of name to table");
    return;
  }
  for (const YamlEntry& entry : node.entries) {
    check_label(reading, entry.where, entry.key);
    plan.tables.push_back(TableReader(reading, plan).read(entry));
  }
}

}  // namespace raystudy
