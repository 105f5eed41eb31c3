#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "harness/spec/formula.h"
#include "harness/spec/quantity.h"
#include "harness/spec/read_columns.h"
#include "harness/spec/read_sections.h"

namespace raystudy {
namespace {

constexpr const char* quantities_expected = "a map of name to column, or a list of quantities";

class TableReader {
 public:
  TableReader(Reading& reading, const Plan& plan) : reading_(reading), plan_(plan), lookup_(reading, plan) {}

  TableSpec read(const YamlEntry& entry) {
    TableSpec table;
    table.name = entry.key;
    table.where = entry.where;
    Fields fields(reading_, *entry.value, fmt::format("table '{}'", entry.key));
    table.caption = fields.text("caption", entry.key);
    const YamlNode* rows = fields.find("rows");
    table.transposed = rows != nullptr && !rows->is_scalar();
    const char* kind_key = table.transposed ? "columns" : "rows";
    table.rows = std::get<std::string>(fields.value(choice_param(kind_key, {"scene", "method"}, "")));
    table.slopes = std::get<bool>(fields.value(boolean_param("slopes", false, "")));
    settings_.by_method = table.rows == "method";
    settings_.word = table.transposed ? "row" : "column";
    for (const YamlEntry& name : fields.names("only")) {
      const std::vector<std::string> labels =
          settings_.by_method ? lookup_.all_of(plan_.pipelines, name, "method") : lookup_.all_of(plan_.scenes, name, "scene");
      table.row_filter.insert(table.row_filter.end(), labels.begin(), labels.end());
    }
    if (const YamlNode* scene = fields.find("scene")) {
      if (!settings_.by_method) {
        reading_.report(scene->where, fmt::format("'scene' stands in a table whose {} are scenes", kind_key),
                        "'only' to choose among them");
      }
      table.scene = table.slopes ? sweep_of(*scene) : lookup_.one_of(plan_.scenes, *scene, "scene").value_or("");
    }
    if (const YamlNode* tracer = fields.find("tracer")) settings_.tracer = lookup_.tracer(*tracer);
    if (const YamlNode* workload = fields.find("workload")) {
      settings_.workload = lookup_.one_of(plan_.workloads, *workload, "workload");
    }
    if (table.transposed) {
      read_columns(*rows, "rows", table);
    } else if (const YamlNode* columns = fields.require("columns", quantities_expected)) {
      read_columns(*columns, "columns", table);
    }
    if (table.slopes) check_slopes(table);
    fields.finish();
    return table;
  }

 private:
  /// The sweep of scenes that the node names.
  [[nodiscard]] std::string sweep_of(const YamlNode& node) const {
    if (!node.is_scalar()) return lookup_.one_of(plan_.scenes, node, "scene").value_or("");
    const std::vector<std::string> labels = lookup_.all_of(plan_.scenes, {node.text, node.where, nullptr}, "scene");
    return labels.empty() ? "" : plan_.scenes[*index_of(plan_.scenes, labels.front())].base;
  }

  void check_slopes(const TableSpec& table) {
    for (const ColumnSpec& column : table.columns) {
      if (column.formula.empty() && column.published.empty() && column.metric != break_even_quantity) continue;
      reading_.report(column.where, fmt::format("{} '{}' stands in a table of slopes", settings_.word, column.name),
                      "a quantity other than break_even, neither a formula nor published");
    }
  }

  void read_columns(const YamlNode& node, const char* key, TableSpec& table) {
    ColumnReader reader(reading_, plan_, lookup_, settings_);
    if (node.is_list()) {
      for (const YamlEntry& name : read_names(reading_, node, fmt::format("'{}'", key))) add(reader.read_quantity(name), table);
    } else if (node.is_map()) {
      for (const YamlEntry& entry : node.entries) add(reader.read(entry, table.columns), table);
    } else {
      reading_.report(node.where, fmt::format("'{}' is {}", key, described(node)), quantities_expected);
    }
    if ((node.is_list() && node.items.empty()) || (node.is_map() && node.entries.empty())) {
      reading_.report(node.where, fmt::format("'{}' is empty", key), fmt::format("at least one {}", settings_.word));
    }
  }

  void add(ColumnSpec column, TableSpec& table) {
    if (!is_formula_name(column.name)) {
      reading_.report(column.where, fmt::format("the {}'s name is '{}'", settings_.word, column.name),
                      "letters, digits and '_', as formulas can hold it");
    }
    const auto same = [&column](const ColumnSpec& other) { return other.name == column.name; };
    if (std::any_of(table.columns.begin(), table.columns.end(), same)) {
      reading_.report(column.where, fmt::format("two {}s are called '{}'", settings_.word, column.name), "each name once");
    }
    table.columns.push_back(std::move(column));
  }

  Reading& reading_;
  const Plan& plan_;
  Lookup lookup_;
  ColumnSettings settings_;
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
