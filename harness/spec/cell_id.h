#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "harness/spec/plan.h"

namespace raystudy {

/// The identity of a cell's result: 32 hex digits of XXH3-128 over everything that can change its numbers, and the labels it is
/// shown by. That is the scene's identity (name, triangles, seed, and for a catalog scene what the catalog says of its files),
/// the methods with all their parameters, tracer, workload, seed, threads, repetitions, warm-up, the cost model, the metrics,
/// the device asked for where the cell uses one,
/// `code_hash` and the plugin files methods come from. Titles, tables, limits and the scale's name are not part of it.
[[nodiscard]] std::string cell_id(const Plan& plan, const Cell& cell);
/// What `cell_id` hashes, one `key: value` a line.
[[nodiscard]] std::string cell_identity(const Plan& plan, const Cell& cell);

/// True where a method of the cell, or one among its parameters, works on a Vulkan device.
[[nodiscard]] bool uses_device(const Plan& plan, const Cell& cell);

/// Hash over the sources of harness/ and methods/ that can change a number (not tests, documentation, report or command line),
/// the compiler and its flags; made when Raystudy is built.
[[nodiscard]] std::string_view code_hash();

/// XXH3-128 of a file's bytes in 32 hex digits; nothing where it cannot be read.
[[nodiscard]] std::optional<std::string> file_hash(const std::string& path);

}  // namespace raystudy
