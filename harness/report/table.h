#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/report/published.h"
#include "harness/report/statistics.h"
#include "harness/report/verdict.h"
#include "harness/run/result.h"
#include "harness/spec/plan.h"

namespace raystudy {

/// Results by what they measured.
class ResultSet {
 public:
  explicit ResultSet(std::vector<CellResult> results = {}) : results_(std::move(results)) {}
  /// Null where there is no such result. Tracer and workload are empty for a build cell.
  [[nodiscard]] const CellResult* find(std::string_view scene, std::string_view method, std::string_view tracer = {},
                                       std::string_view workload = {}) const;
  [[nodiscard]] const std::vector<CellResult>& all() const { return results_; }

 private:
  std::vector<CellResult> results_;
};

struct ReportCell {
  std::optional<ValueClass> value_class;  ///< of ours, else of the published value
  std::optional<PublishedValue> published;
  std::optional<Estimate> ours;     ///< in the column's unit
  bool shows_error = false;         ///< the interval is one standard error to each side
  std::optional<double> range_end;  ///< where ours begins a range: its end, infinite where it has none
  std::optional<double> ratio;      ///< ours / published
  std::optional<Target> target;     ///< what ours is to reach
  Verdict verdict = Verdict::none;
  std::string absence;  ///< where there is no value of ours: "not run", "failed", "not installed", "never", "none"
  std::string reason;   ///< why there is none, or what the verdict rests on
};

struct ReportColumn {
  std::string name;
  std::string label;
  std::string unit;  ///< empty for a pure number
  int decimals = 2;
  const PublishedColumn* published = nullptr;
};

struct ReportRow {
  std::string label;
  std::vector<ReportCell> cells;  ///< one a column
};

/// A table ready to be written in any format.
struct ReportTable {
  std::string name;
  std::string caption;
  std::string row_heading;
  bool transposed = false;  ///< shown with a line for each column, rows side by side
  std::vector<ReportColumn> columns;
  std::vector<ReportRow> rows;
  /// What always stands under a table: cost model, conditions, machine.
  std::vector<std::string> remarks;
  double traversal = 3;     ///< c_T
  double intersection = 2;  ///< c_I
  std::string heuristic;
  std::string citation;  ///< of the published values; empty where the table has none

  [[nodiscard]] bool has_published() const;
  [[nodiscard]] bool has_targets() const;
};

/// results/published/<paper>.yaml beside the experiment's folder, else of the source tree, else the installed one. Nothing where
/// the plan names no paper. Throws Error where the file is not there or wrong.
[[nodiscard]] std::optional<Published> published_of(const Plan& plan);

/// Everything wrong with the plan's tables that only the report can know: published keys and units. Throws one Error with all of
/// it.
void check_tables(const Plan& plan, const Published* published);

/// The tables of a plan, filled. One whose rows are methods and that names no scene comes once for each scene. `published` must
/// outlive the tables.
[[nodiscard]] std::vector<ReportTable> build_tables(const Plan& plan, const ResultSet& results, const Published* published);

}  // namespace raystudy
