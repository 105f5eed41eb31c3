#pragma once

#include <optional>
#include <string>
#include <vector>

#include "harness/spec/lookup.h"
#include "harness/spec/reading.h"

namespace raystudy {

/// What a table settles for its columns.
struct ColumnSettings {
  bool by_method = false;  ///< the rows are methods, and the columns name none
  const char* word = "";   ///< what a column is called in messages: in a transposed table it is a row
  std::optional<std::string> tracer;
  std::optional<std::string> workload;
};

/// Reads the columns of a table, reports what is wrong with them, and fills in what they leave open and the table or the plan
/// settles.
class ColumnReader {
 public:
  ColumnReader(Reading& reading, const Plan& plan, const Lookup& lookup, ColumnSettings settings)
      : reading_(reading), plan_(plan), lookup_(lookup), settings_(std::move(settings)) {}

  /// A quantity named in a list.
  [[nodiscard]] ColumnSpec read_quantity(const YamlEntry& name);
  /// `name: quantity`, or `name: {…}`. A formula may name the columns `before`.
  [[nodiscard]] ColumnSpec read(const YamlEntry& entry, const std::vector<ColumnSpec>& before);

 private:
  [[nodiscard]] std::string owner(const ColumnSpec& column) const;
  void check_formula(const ColumnSpec& column, const SourceLocation& where, const std::vector<ColumnSpec>& before);
  void read_published(Fields& fields, ColumnSpec& column);
  void read_targets(Fields& fields, ColumnSpec& column);
  void read_methods(Fields& fields, ColumnSpec& column);
  void read_dimensions(Fields& fields, ColumnSpec& column);
  void read_place_on_axis(Fields& fields, ColumnSpec& column);
  [[nodiscard]] std::vector<std::string> method_list(const YamlNode& node, const std::string& key);
  [[nodiscard]] std::vector<std::string> scenes_named(const YamlEntry& entry) const;
  void complete_metric(ColumnSpec& column, const SourceLocation& where, const std::optional<YamlEntry>& unit);
  [[nodiscard]] std::string natural_unit(const ColumnSpec& column, const Quantity& quantity, const SourceLocation& where);
  void check_break_even(const ColumnSpec& column, const SourceLocation& where);
  void complete_tracing(ColumnSpec& column, const Quantity& quantity, const SourceLocation& where);

  Reading& reading_;
  const Plan& plan_;
  const Lookup& lookup_;
  ColumnSettings settings_;
};

}  // namespace raystudy
