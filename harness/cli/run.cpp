#include "harness/run/run.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "harness/cli/plan_options.h"
#include "harness/cli/verb.h"
#include "harness/report/figure.h"
#include "harness/report/report.h"
#include "harness/run/provenance.h"
#include "harness/vulkan/device.h"

namespace raystudy::cli {
namespace {

struct RunFlags {
  PlanOptions plan;
  std::string results;
  bool force = false;
  double timeout = -1;
  int threads = 0;
  int repetitions = 0;
  std::string device;
  std::string command;
};

void require(bool right, std::string_view flag, double found, std::string_view expected) {
  if (!right) throw Error(Diagnostic{{}, fmt::format("{} is {}", flag, found), std::string(expected), {}});
}

/// Flags in place of what the experiment says.
void apply(const RunFlags& flags, const CLI::App& app, Plan& plan) {
  if (app.count("--timeout") > 0) {
    require(std::isfinite(flags.timeout) && flags.timeout > 0, "--timeout", flags.timeout, "a number of seconds > 0");
    plan.timeout_seconds = flags.timeout;
  }
  if (app.count("--threads") > 0) {
    require(flags.threads >= 1, "--threads", flags.threads, "an integer >= 1");
    plan.threads = flags.threads;
  }
  if (app.count("--repetitions") > 0) {
    require(flags.repetitions >= 1, "--repetitions", flags.repetitions, "an integer >= 1");
    plan.repetitions = flags.repetitions;
  }
  plan.device = flags.device;
}

/// Of the whole experiment, whatever part of it this run measured.
void print_report(const RunFlags& flags, const CLI::App& app, bool draw) {
  Plan plan = read_plan(flags.plan.file, read_scale(flags.plan.scale));
  apply(flags, app, plan);
  const Report report(std::move(plan), flags.results);
  print_tables(report, std::cout);
  std::cout.flush();
  if (!draw) return;
  const std::filesystem::path folder = results_folder(report.plan(), flags.results) / "figures";
  for (const FigureOutcome& outcome : write_figures(report, folder)) fmt::print(stderr, "{}", outcome_text(outcome));
}

int run(const RunFlags& flags, const CLI::App& app) {
  Plan plan = read_selected_plan(flags.plan);
  apply(flags, app, plan);
  const std::optional<Published> published = published_of(plan);
  check_tables(plan, published ? &*published : nullptr);
  if (!plan.device.empty()) vulkan::check_device(plan.device);
  RunOptions options;
  options.results = flags.results;
  options.force = flags.force;
  options.command = flags.command;
  const RunSummary summary = run_plan(plan, options);
  print_report(flags, app, !summary.interrupted);
  fmt::print(stderr, "{}\n", summary.text());
  if (summary.interrupted) {
    fmt::print(stderr, "interrupted; what is measured is kept, and the same command goes on from there\n");
    return exit_interrupted;
  }
  return summary.failed > 0 ? exit_failed_rows : exit_ok;
}

const Verb verb{"run", "Measure an experiment's cells that have no result yet, and print its tables", [](CLI::App& app) {
                  auto flags = std::make_shared<RunFlags>();
                  flags->results = default_results();
                  add_plan_options(app, flags->plan);
                  app.add_option("--results", flags->results, "folder of the results (RAYSTUDY_RESULTS)")->capture_default_str();
                  app.add_flag("--force", flags->force, "measure again what has a result");
                  app.add_option("--timeout", flags->timeout, "seconds that one cell may take, its repetitions together");
                  app.add_option("--threads", flags->threads, "threads of builds and traces, in place of the experiment's");
                  app.add_option("--repetitions", flags->repetitions, "in place of the experiment's");
                  flags->device = vulkan::device_of_environment();
                  app.add_option("--device", flags->device,
                                 "Vulkan device by name or number ('raystudy list devices'; RAYSTUDY_DEVICE)");
                  return [flags, &app]() -> int {
                    flags->command = command_line();
                    return run(*flags, app);
                  };
                }};

}  // namespace
}  // namespace raystudy::cli
