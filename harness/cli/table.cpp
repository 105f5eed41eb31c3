#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/cli/plan_options.h"
#include "harness/cli/verb.h"
#include "harness/report/format.h"
#include "harness/report/report.h"

namespace raystudy::cli {
namespace {

struct TableFlags {
  PlanOptions plan;
  std::string results = default_results();
  std::string table;
  std::string format = "markdown";
  std::string output;
};

int table(const TableFlags& flags) {
  const TableFormat format = table_format(flags.format);
  const Report report(read_selected_plan(flags.plan), flags.results);
  std::ostringstream text;
  write_tables(report.tables(flags.table), format, text);
  // What is not a table goes to standard error, so that the tables can be piped into other programs.
  if (flags.output.empty()) {
    std::cout << text.str() << std::flush;
  } else {
    write_file_atomically(flags.output, text.str());
  }
  for (const std::string& line : report.gaps()) fmt::print(stderr, "{}\n", line);
  return exit_ok;
}

const Verb verb{"table", "Print an experiment's tables from its results", [](CLI::App& app) {
                  auto flags = std::make_shared<TableFlags>();
                  add_plan_options(app, flags->plan);
                  app.add_option("--results", flags->results, "folder of the results (RAYSTUDY_RESULTS)")->capture_default_str();
                  app.add_option("--table", flags->table, "only this table");
                  app.add_option("--format", flags->format, "markdown, latex, csv (one line a cell) or csv-wide (one line a row)")
                      ->capture_default_str();
                  app.add_option("-o,--output", flags->output, "write to this file instead of the terminal");
                  return [flags]() -> int { return table(*flags); };
                }};

}  // namespace
}  // namespace raystudy::cli
