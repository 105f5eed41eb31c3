#include "harness/report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "harness/cli/plan_options.h"
#include "harness/cli/verb.h"
#include "harness/run/run.h"

namespace raystudy::cli {
namespace {

struct FigureFlags {
  PlanOptions plan;
  std::string results = default_results();
  std::string figure;
  std::string output;
};

int figure(const FigureFlags& flags) {
  const Report report(read_selected_plan(flags.plan), flags.results);
  const std::filesystem::path folder =
      flags.output.empty() ? results_folder(report.plan(), flags.results) / "figures" : std::filesystem::path(flags.output);
  const std::vector<FigureOutcome> outcomes = write_figures(report, folder, flags.figure);
  for (const FigureOutcome& outcome : outcomes) fmt::print("{}", outcome_text(outcome));
  return std::any_of(outcomes.begin(), outcomes.end(), [](const FigureOutcome& o) { return o.failed; }) ? exit_failed_rows
                                                                                                        : exit_ok;
}

const Verb verb{"figure", "Draw an experiment's figures from its results", [](CLI::App& app) {
                  auto flags = std::make_shared<FigureFlags>();
                  add_plan_options(app, flags->plan);
                  app.add_option("name", flags->figure, "only this figure");
                  app.add_option("--results", flags->results, "folder of the results (RAYSTUDY_RESULTS)")->capture_default_str();
                  app.add_option("-o,--output", flags->output,
                                 "folder of the pictures; RESULTS/EXPERIMENT/figures where none is named");
                  return [flags]() -> int { return figure(*flags); };
                }};

}  // namespace
}  // namespace raystudy::cli
