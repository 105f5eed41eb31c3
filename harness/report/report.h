#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "harness/report/format.h"
#include "harness/report/published.h"
#include "harness/report/table.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// A plan with its results and the paper's values, ready to be shown. Results are looked up by cell id, so that one of other code
/// or other settings is never shown as this plan's.
class Report {
 public:
  /// Reads `<results>/<plan's name>/` and results/published/<paper>.yaml. Throws Error for what cannot be read and for what is
  /// wrong with the tables.
  Report(Plan plan, const std::filesystem::path& results);
  /// Of results at hand.
  Report(Plan plan, std::vector<CellResult> results);

  [[nodiscard]] const Plan& plan() const { return plan_; }
  [[nodiscard]] const ResultSet& results() const { return results_; }
  /// All tables, or the one called `name` (which comes once a scene where it names none). Throws Error with the nearest name.
  [[nodiscard]] std::vector<ReportTable> tables(const std::string& name = {}) const;
  /// What may not be seen in the tables: how many cells have no result, which failed and why, and how many results in the folder
  /// are of other code or settings. One finding a line.
  [[nodiscard]] std::vector<std::string> gaps() const;

 private:
  Plan plan_;
  ResultSet results_;
  std::optional<Published> published_;
  std::size_t other_results_ = 0;  ///< in the folder, but of no cell of the plan
};

/// All tables in Markdown, then the gaps.
void print_tables(const Report& report, std::ostream& out);

}  // namespace raystudy
