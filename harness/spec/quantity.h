#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// A named figure that a cell's result can hold: what a table's column or a line figure may ask for.
struct Quantity {
  std::string name;     ///< key in CellResult::values or ::series
  std::string unit;     ///< "s", "bytes", "rays/s"; "1" for a pure number
  std::string summary;  ///< one line
  bool traced = false;  ///< belongs to a cell with tracer and workload; else to the build
  std::string axis{};   ///< what a series runs over, e.g. "depth"; empty for a single number
  bool higher_is_better = false;
  bool animated = false;  ///< there is one only where the experiment plays animations
};

/// The quantity that is not measured but follows from a table's methods together: for how many rays each is the fastest.
inline constexpr const char* break_even_quantity = "break_even";

/// What the harness itself measures: stage times, peak memory, rays a second, the cost while optimizing.
[[nodiscard]] const std::vector<Quantity>& harness_quantities();
/// The quantity that a part of a builder's time is (MethodInfo::parts), `build_time:PART`; and those of all registered builders.
[[nodiscard]] std::string build_part_quantity(std::string_view part);
[[nodiscard]] std::vector<Quantity> build_part_quantities();
/// What a registered Metric says it gives (MethodInfo::values). Throws Error for an unknown name.
[[nodiscard]] std::vector<Quantity> metric_quantities(std::string_view metric);

/// What a number in unit `from` is multiplied by to be shown in unit `to`: s → ms, bytes → MiB, rays/s → Mrays/s, a pure number →
/// %. Nothing where one is not the other.
[[nodiscard]] std::optional<double> unit_factor(std::string_view from, std::string_view to);
/// Every unit that `from` can be shown in, itself first.
[[nodiscard]] std::vector<std::string> units_for(std::string_view from);

}  // namespace raystudy
