#pragma once

#include <string>
#include <string_view>

#include "harness/spec/plan.h"

namespace raystudy {

/// The identity of a cell's result: 32 hex digits of XXH3-128 over everything that can change its numbers. That is the scene's
/// identity (name, triangles, seed, and for a catalog scene what the catalog says of its files), the methods with all their
/// parameters, tracer, workload, seed, threads, repetitions, warm-up, the cost model, the metrics, and `code_hash`. Titles,
/// labels, tables, limits and the scale's name are not part of it: two cells that would measure the same share one result.
[[nodiscard]] std::string cell_id(const Plan& plan, const Cell& cell);
/// What `cell_id` hashes, in words; for `raystudy plan --why` and tests.
[[nodiscard]] std::string cell_identity(const Plan& plan, const Cell& cell);

/// Hash over the sources of harness/ and methods/ that can change a number (not tests, documentation, report or command line),
/// the compiler and its flags; made when Raystudy is built.
[[nodiscard]] std::string_view code_hash();

}  // namespace raystudy
