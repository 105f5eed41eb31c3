#include "harness/spec/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "harness/cli/plan_options.h"
#include "harness/cli/verb.h"
#include "harness/spec/cell_id.h"
#include "harness/spec/cells.h"
#include "harness/spec/rays.h"

namespace raystudy::cli {
namespace {

std::string stages_text(const PipelineSpec& pipeline) {
  std::string text = canonical(pipeline.builder);
  for (const MethodRef& optimizer : pipeline.optimizers) text += " → " + canonical(optimizer);
  if (pipeline.updater) text += " → " + canonical(*pipeline.updater);
  if (pipeline.encoder) text += " → " + canonical(*pipeline.encoder);
  return text;
}

/// 1234567 → "1,234,567".
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (auto i = static_cast<std::ptrdiff_t>(text.size()) - 3; i > 0; i -= 3) text.insert(static_cast<std::size_t>(i), ",");
  return text;
}

template <class T>
std::size_t widest(const std::vector<T>& things) {
  std::size_t most = 0;
  for (const T& thing : things) most = std::max(most, thing.label.size());
  return most;
}

void print_matrix(const Plan& plan) {
  fmt::print("{}: {} (scale {})\n", plan.file, plan.title, scale_name(plan.scale));
  fmt::print("  {} threads, {} repetitions, seed {}, c_T = {}, c_I = {}, {}\n", plan.threads, plan.repetitions, plan.seed,
             plan.cost.traversal, plan.cost.intersection, canonical(plan.cost.heuristic));
  if (plan.animation) fmt::print("  animations of {} frames\n", plan.animation->frames);
  fmt::print("scenes\n");
  for (const SceneSpec& scene : plan.scenes) {
    const std::string size = scene.triangles > 0 ? fmt::format("{} triangles, seed {}",
                                                               grouped(static_cast<std::uint64_t>(scene.triangles)), scene.seed)
                                                 : "";
    fmt::print("  {:<{}}  {}{}\n", scene.label, widest(plan.scenes), scene.name == scene.label ? "" : scene.name + " ", size);
  }
  fmt::print("methods\n");
  for (const PipelineSpec& pipeline : plan.pipelines) {
    fmt::print("  {:<{}}  {}\n", pipeline.label, widest(plan.pipelines), stages_text(pipeline));
    if (pipeline.tracers.size() != plan.tracers.size()) {
      fmt::print("  {:<{}}  traced by {}\n", "", widest(plan.pipelines),
                 pipeline.tracers.empty() ? std::string("none") : fmt::format("{}", fmt::join(pipeline.tracers, ", ")));
    }
  }
  if (!plan.tracers.empty()) fmt::print("tracers\n");
  for (const TracerSpec& tracer : plan.tracers) {
    fmt::print("  {:<{}}  {}\n", tracer.label, widest(plan.tracers), canonical(tracer.tracer));
  }
  if (!plan.workloads.empty()) fmt::print("workloads\n");
  for (const WorkloadSpec& workload : plan.workloads) {
    fmt::print("  {:<{}}  {}, at most {} rays\n", workload.label, widest(plan.workloads), canonical(workload.workload),
               grouped(estimated_rays(workload.workload)));
  }
}

void print_totals(const Plan& plan) {
  std::size_t builds = 0;
  std::uint64_t rays = 0;
  for (const Cell& cell : plan.cells) {
    if (!cell.workload) ++builds;
    if (cell.workload) rays += estimated_rays(plan.workloads[*cell.workload].workload);
  }
  fmt::print("{} cells: {} builds, {} traced; at most {} rays a repetition\n", plan.cells.size(), builds,
             plan.cells.size() - builds, grouped(rays));
}

int print_plan(const PlanOptions& options, bool cells) {
  const Plan plan = read_selected_plan(options);
  print_matrix(plan);
  if (cells) {
    fmt::print("cells\n");
    for (const Cell& cell : plan.cells) fmt::print("  {}  {}\n", cell_id(plan, cell), cell_path(plan, cell));
  }
  print_totals(plan);
  return exit_ok;
}

const Verb verb{"plan", "The matrix of an experiment: scenes, methods, rays, and how many cells they make", [](CLI::App& app) {
                  auto options = std::make_shared<PlanOptions>();
                  auto cells = std::make_shared<bool>(false);
                  add_plan_options(app, *options);
                  app.add_flag("--cells", *cells, "list every cell with the name of its result");
                  return [options, cells] { return print_plan(*options, *cells); };
                }};

}  // namespace
}  // namespace raystudy::cli
