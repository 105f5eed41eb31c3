#include "harness/cli/plan_options.h"

#include <fmt/format.h>

#include <cstdlib>

#include "harness/spec/cells.h"

namespace raystudy::cli {

void add_plan_options(CLI::App& app, PlanOptions& options) {
  app.add_option("experiment", options.file, "the experiment's YAML file")->required();
  app.add_option("--scale", options.scale, "quick (a look), full (a result) or paper (the publication's own sizes)")
      ->capture_default_str();
  app.add_option("--only", options.only, "cells whose scene/method/tracer/workload matches, * standing for anything");
  app.add_option("--shard", options.shard, "i/n: every n-th scene from the i-th on, for n machines");
}

std::string default_results() {
  const char* folder = std::getenv("RAYSTUDY_RESULTS");
  return folder != nullptr && *folder != '\0' ? folder : "results";
}

Scale read_scale(const std::string& name) {
  std::vector<std::string> known;
  for (const Scale scale : {Scale::quick, Scale::full, Scale::paper}) {
    if (scale_name(scale) == name) return scale;
    known.emplace_back(scale_name(scale));
  }
  throw Error(Diagnostic{
      {}, fmt::format("--scale is '{}'", name), fmt::format("one of {}", fmt::join(known, ", ")), nearest_name(name, known)});
}

Plan read_selected_plan(const PlanOptions& options) {
  const Scale scale = read_scale(options.scale);
  const Shard shard = options.shard.empty() ? Shard{} : read_shard(options.shard);
  Plan plan = read_plan(options.file, scale);
  select_cells(plan, options.only, shard);
  return plan;
}

}  // namespace raystudy::cli
