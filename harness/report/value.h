#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/report/statistics.h"
#include "harness/report/table.h"

namespace raystudy {

/// A value looked up or computed, or why there is none.
struct FoundValue {
  std::optional<Bootstrapped> value;  ///< in the column's unit
  ValueClass value_class = ValueClass::exact;
  std::vector<const CellResult*> timed_results;  ///< the results that its times come from; empty where exact
  std::string absence;                           ///< as in ReportCell
  std::string reason;
};

/// Where in the matrix a column's value stands on one row.
struct ValuePlace {
  std::string scene;
  std::string method;
  std::string tracer;
  std::string workload;
};

/// The value of a `column` that names a metric at `place`, divided by relative_to's where the column is relative, in `unit`.
[[nodiscard]] FoundValue find_value(const ColumnSpec& column, const ValuePlace& place, std::string_view unit,
                                    const ResultSet& results);

/// The value of a `column` that is a formula, over the values of the columns before it, as shown: `columns` and `values` go
/// together. Of times it is a ratio where `unit` is a pure number's.
[[nodiscard]] FoundValue find_formula(const ColumnSpec& column, const std::vector<ColumnSpec>& columns,
                                      const std::vector<FoundValue>& values, std::string_view unit);

/// What makes times of two results not comparable: "cpu: A and B"; empty where they come from one machine and build.
[[nodiscard]] std::string machine_difference(const CellResult& a, const CellResult& b);

}  // namespace raystudy
