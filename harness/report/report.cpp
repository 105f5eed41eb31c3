#include "harness/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <ostream>
#include <set>
#include <system_error>
#include <utility>

#include "harness/run/run.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// Results (32 hex digits and .json) in the folder that belong to no cell of the plan.
std::size_t count_others(const Plan& plan, const fs::path& folder) {
  std::set<std::string> ids;
  for (const Cell& cell : plan.cells) ids.insert(cell_id(plan, cell));
  std::size_t others = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string stem = entry.path().stem().string();
    const bool is_result = entry.path().extension() == ".json" && stem.size() == 32 &&
                           stem.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (is_result && !ids.contains(stem)) ++others;
  }
  return others;
}

std::string counted(std::size_t count, std::string_view singular, std::string_view plural) {
  return fmt::format("{} {}", count, count == 1 ? singular : plural);
}

}  // namespace

Report::Report(Plan plan, const fs::path& results)
    : plan_(std::move(plan)),
      results_(read_results(plan_, results)),
      published_(published_of(plan_)),
      other_results_(count_others(plan_, results_folder(plan_, results))) {
  check_tables(plan_, published_ ? &*published_ : nullptr);
}

Report::Report(Plan plan, std::vector<CellResult> results)
    : plan_(std::move(plan)), results_(std::move(results)), published_(published_of(plan_)) {
  check_tables(plan_, published_ ? &*published_ : nullptr);
}

std::vector<ReportTable> Report::tables(const std::string& name) const {
  const Published* published = published_ ? &*published_ : nullptr;
  if (name.empty()) return build_tables(plan_, results_, published);
  std::vector<std::string> names;
  for (const TableSpec& table : plan_.tables) names.push_back(table.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    throw Error(Diagnostic{{plan_.file, 0, 0},
                           fmt::format("there is no table '{}'", name),
                           names.empty() ? "an experiment with tables" : fmt::format("one of {}", fmt::join(names, ", ")),
                           nearest_name(name, names)});
  }
  Plan one = plan_;
  one.tables = {plan_.tables[static_cast<std::size_t>(found - names.begin())]};
  return build_tables(one, results_, published);
}

std::vector<std::string> Report::gaps() const {
  std::vector<std::string> lines;
  const std::size_t missing = plan_.cells.size() - std::min(plan_.cells.size(), results_.all().size());
  if (missing > 0) {
    lines.push_back(fmt::format("{} of {} no result yet: raystudy run {}{}", missing,
                                counted(plan_.cells.size(), "cell has", "cells have"), plan_.file,
                                plan_.scale == Scale::quick ? "" : fmt::format(" --scale {}", scale_name(plan_.scale))));
  }
  for (const CellResult& result : results_.all()) {
    if (result.status != CellStatus::failed) continue;
    std::string cell = fmt::format("{}/{}", result.scene, result.method);
    if (!result.workload.empty()) cell += fmt::format("/{}/{}", result.tracer, result.workload);
    lines.push_back(fmt::format("failed: {}: {}", cell, result.reason));
  }
  if (other_results_ > 0) {
    lines.push_back(fmt::format("{} in the folder {} of other code, scale or settings and {} not shown",
                                counted(other_results_, "result", "results"), other_results_ == 1 ? "is" : "are",
                                other_results_ == 1 ? "is" : "are"));
  }
  return lines;
}

void print_tables(const Report& report, std::ostream& out) {
  write_markdown(report.tables(), out);
  const std::vector<std::string> gaps = report.gaps();
  if (!gaps.empty()) out << '\n';
  for (const std::string& line : gaps) out << line << '\n';
}

}  // namespace raystudy
