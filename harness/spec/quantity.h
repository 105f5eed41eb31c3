#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// A named figure that a cell's result can hold: what a table's column or a line figure may ask for.
struct Quantity {
  std::string name;     ///< key in CellResult::values or ::series
  std::string unit;     ///< "s", "bytes", "rays/s", "1" for a pure number
  std::string summary;  ///< one line
  bool traced = false;  ///< belongs to a cell with tracer and workload; else to the build
  std::string axis{};   ///< what a series runs over, e.g. "depth"; empty for a single number
};

/// What the harness itself measures: stage times, peak memory, rays a second, the cost while optimizing.
[[nodiscard]] const std::vector<Quantity>& harness_quantities();
/// Those, and the ones every registered Metric says it gives (MethodInfo::values).
[[nodiscard]] std::vector<Quantity> known_quantities();

}  // namespace raystudy
