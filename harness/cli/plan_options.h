#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "harness/spec/plan.h"

namespace raystudy::cli {

/// What the verbs that work on a plan share: the experiment, and which part of it at which scale.
struct PlanOptions {
  std::string file;
  std::string scale = "quick";
  std::string only;
  std::string shard;
};

/// Adds `experiment`, `--scale`, `--only` and `--shard` to a verb; `options` must outlive the parsing.
void add_plan_options(CLI::App& app, PlanOptions& options);
/// Reads the plan and keeps the cells asked for. Throws Error.
[[nodiscard]] Plan read_selected_plan(const PlanOptions& options);
/// RAYSTUDY_RESULTS, or the folder `results` here.
[[nodiscard]] std::string default_results();
/// Throws Error with the nearest scale.
[[nodiscard]] Scale read_scale(const std::string& name);

}  // namespace raystudy::cli
