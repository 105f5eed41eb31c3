#pragma once

#include <string>
#include <vector>

#include "harness/spec/reading.h"

namespace raystudy {

/// One parameter of a sweep and the value it has at this point.
struct SweepValue {
  std::string method;  ///< the method whose parameter it is
  std::string param;
  ParamValue value;
};

/// A method with one value for each parameter: one point of its sweep.
struct MethodChoice {
  MethodRef ref;
  std::vector<SweepValue> sweep;  ///< in the order of the file; empty without lists
  SourceLocation where;
};

inline constexpr std::size_t max_sweep_points = 10'000;

/// Reads `NAME`, `NAME: {param: value, ...}` or a list of those, all of one role. A list, here or as a parameter's value, gives
/// one choice an item; several lists give every combination, the last varying fastest. Reports everything that is wrong; empty
/// where nothing could be made of it. `what` is what a list of methods sweeps over, e.g. "builder".
[[nodiscard]] std::vector<MethodChoice> read_method(Reading& reading, const YamlNode& node, Role role, const std::string& what);

/// `base`, or `base[param=value,...]` where there is a sweep. A parameter that two methods of the sweep share is written
/// `method.param`.
[[nodiscard]] std::string sweep_label(const std::string& base, const std::vector<SweepValue>& sweep);
/// The names that `sweep_label` gives the parameters, in order.
[[nodiscard]] std::vector<std::string> sweep_names(const std::vector<SweepValue>& sweep);

}  // namespace raystudy
