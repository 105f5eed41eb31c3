#pragma once

#include <string>

namespace raystudy {

/// The JSON Schema (draft 2020-12) of an experiment, made from the registry, for editors that complete and check YAML. It knows
/// the names, types and ranges; what hangs together (from, labels, kinds of structures) only read_plan checks.
[[nodiscard]] std::string experiment_schema();

}  // namespace raystudy
