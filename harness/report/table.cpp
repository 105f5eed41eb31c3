#include "harness/report/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "harness/report/break_even.h"
#include "harness/report/slope.h"
#include "harness/report/value.h"
#include "harness/spec/quantity.h"
#include "harness/spec/reading.h"

namespace raystudy {
namespace {

constexpr std::string_view not_at_hand = "not installed";

const PublishedColumn* published_column(const ColumnSpec& column, const Published* published) {
  return published == nullptr || column.published.empty() ? nullptr : published->find(column.published);
}

/// The unit a column is shown in: its own, else the published one; empty for a pure number.
std::string shown_unit(const ColumnSpec& column, const Published* published) {
  if (!column.unit.empty()) return column.unit == "1" ? "" : column.unit;
  if (const PublishedColumn* p = published_column(column, published)) return p->unit;
  return "";
}

/// One row before its values: what it is called, and which scene and method it stands for.
struct RowPlace {
  std::string label;
  std::string scene;   ///< label
  std::string method;  ///< label; empty where the columns name it
};

std::vector<RowPlace> rows_of(const TableSpec& table, const Plan& plan, const std::string& scene) {
  const bool by_sweep = table.slopes && table.rows == "scene";
  std::vector<std::string> labels = by_sweep ? scene_bases(plan, table.row_filter) : table.row_filter;
  if (labels.empty()) {
    if (table.rows == "scene") {
      for (const SceneSpec& s : plan.scenes) labels.push_back(s.label);
    } else {
      for (const PipelineSpec& p : plan.pipelines) labels.push_back(p.label);
    }
  }
  std::vector<RowPlace> rows;
  rows.reserve(labels.size());
  for (std::string& label : labels) {
    rows.push_back(table.rows == "scene" ? RowPlace{label, label, {}} : RowPlace{label, scene, label});
  }
  return rows;
}

/// The name by which the paper's values of a row are found, and the paper's scene.
struct PaperRow {
  std::string key;
  const PublishedScene* scene = nullptr;
};

PaperRow paper_row(const RowPlace& row, const PublishedColumn& column, const Plan& plan, const Published& published) {
  const auto spec =
      std::find_if(plan.scenes.begin(), plan.scenes.end(), [&](const SceneSpec& s) { return s.label == row.scene; });
  const PublishedScene* scene = spec == plan.scenes.end() ? nullptr : published.scene_of(spec->name);
  if (column.rows == PublishedRows::scene) return {scene == nullptr ? "" : scene->name, scene};
  return {row.method, scene};
}

/// Fills one table, column by column, then judges.
class TableBuilder {
 public:
  TableBuilder(const TableSpec& spec, const Plan& plan, const ResultSet& results, const Published* published)
      : spec_(spec), plan_(plan), results_(results), published_(published) {}

  ReportTable build(const std::string& scene) {
    start(scene);
    const std::vector<RowPlace> rows = rows_of(spec_, plan_, scene);
    for (const RowPlace& row : rows) fill_row(row);
    for (const auto& [column, contest] : contests_) settle(column, contest);
    judge_all();
    add_remarks();
    if (spec_.rows == "scene" && spec_.row_filter.empty()) add_rows_without_scene();
    return std::move(table_);
  }

 private:
  /// A cell that can be judged, and which quantity it is: cells of one group are each other's peers.
  struct Judged {
    std::size_t row = 0;
    std::size_t column = 0;
    std::string group;
    const PublishedScene* scene = nullptr;
  };

  /// The methods of a break-even column, and their rows.
  struct Contest {
    std::vector<ValuePlace> places;
    std::vector<std::size_t> rows;
  };

  void start(const std::string& scene) {
    table_.name = scene.empty() || !spec_.scene.empty() ? spec_.name : fmt::format("{}/{}", spec_.name, scene);
    table_.caption = spec_.caption;
    if (spec_.rows != "scene") table_.caption += fmt::format("{}{}", table_.caption.empty() ? "" : ": ", scene);
    table_.transposed = spec_.transposed;
    table_.row_heading = spec_.transposed ? "" : spec_.rows == "scene" ? "Scene" : "Method";
    for (const ColumnSpec& c : spec_.columns) {
      table_.columns.push_back({c.name, c.label.empty() ? c.name : c.label, spec_.slopes ? "" : shown_unit(c, published_),
                                c.decimals, published_column(c, published_)});
    }
    table_.traversal = plan_.cost.traversal;
    table_.intersection = plan_.cost.intersection;
    table_.heuristic = plan_.cost.heuristic.name;
    if (table_.has_published()) table_.citation = published_->citation;
  }

  [[nodiscard]] bool is_traced(const std::string& method, const std::string& tracer) const {
    if (tracer.empty()) return true;
    const auto found =
        std::find_if(plan_.pipelines.begin(), plan_.pipelines.end(), [&](const PipelineSpec& p) { return p.label == method; });
    if (found == plan_.pipelines.end()) return true;
    if (tracer == own_tracer) return found->tracers.size() == 1;
    return std::find(found->tracers.begin(), found->tracers.end(), tracer) != found->tracers.end();
  }

  void fill_row(const RowPlace& place) {
    ReportRow row{place.label, {}};
    std::vector<FoundValue> values;
    for (std::size_t i = 0; i < spec_.columns.size(); ++i) {
      const ColumnSpec& column = spec_.columns[i];
      const std::string method = column.methods.empty() ? place.method : column.methods.front();
      const ValuePlace value_place{place.scene, method, column.tracer, column.workload};
      if (column.methods.size() < 2 && !is_traced(method, column.tracer)) {
        // The study has no such cell, which is not the same as one that has not been run.
        values.emplace_back().absence = "none";
        row.cells.emplace_back().absence = "none";
        continue;
      }
      if (spec_.slopes) {
        ReportCell cell = slope_cell(column, value_place, plan_, results_);
        const std::vector<const SceneSpec*> scenes = scenes_of(plan_, place.scene);
        const auto target = scenes.empty() ? column.targets.end() : column.targets.find(scenes.front()->label);
        if (target != column.targets.end()) add_target(cell, target->second);
        row.cells.push_back(std::move(cell));
        continue;
      }
      if (column.metric == break_even_quantity) {
        contests_[i].places.push_back(value_place);
        contests_[i].rows.push_back(table_.rows.size());
        values.emplace_back().absence = "none";
        row.cells.emplace_back();
        continue;
      }
      const FoundValue& found =
          values.emplace_back(column.formula.empty() ? find_value(column, value_place, table_.columns[i].unit, results_)
                                                     : find_formula(column, spec_.columns, values, table_.columns[i].unit));
      ReportCell cell;
      if (found.value) {
        cell.value_class = found.value_class;
        cell.ours = found.value->estimate();
      }
      cell.absence = found.absence;
      cell.reason = found.reason;
      if (const auto target = column.targets.find(place.scene); target != column.targets.end()) add_target(cell, target->second);
      if (table_.columns[i].published != nullptr) add_published(cell, place, i, value_place);
      row.cells.push_back(std::move(cell));
    }
    table_.rows.push_back(std::move(row));
  }

  void settle(std::size_t column, const Contest& contest) {
    const std::vector<ReportCell> cells = break_even_cells(contest.places, results_);
    for (std::size_t i = 0; i < cells.size(); ++i) table_.rows[contest.rows[i]].cells[column] = cells[i];
  }

  static void add_target(ReportCell& cell, const Target& target) {
    cell.target = target;
    if (!cell.ours) return;
    const Judgement judgement = judge(target, *cell.ours);
    cell.verdict = judgement.verdict;
    cell.reason = joined(cell.reason, judgement.reason);
  }

  void add_published(ReportCell& cell, const RowPlace& place, std::size_t i, const ValuePlace& value_place) {
    const PublishedColumn& column = *table_.columns[i].published;
    const PaperRow paper = paper_row(place, column, plan_, *published_);
    const auto value = column.values.find(paper.key);
    if (value == column.values.end()) return;
    cell.published = value->second;
    if (!cell.value_class) cell.value_class = column.value_class;
    if (!cell.ours) return;
    if (value->second.value != 0) cell.ratio = cell.ours->value / value->second.value;
    const ColumnSpec& spec = spec_.columns[i];
    // A formula's value has no peers: what it is made of differs from column to column.
    const std::string quantity =
        spec.metric.empty() ? spec.name : fmt::format("{}\n{}", spec.metric, fmt::join(spec.relative_to, "\n"));
    judged_.push_back({table_.rows.size(), i,
                       fmt::format("{}\n{}\n{}\n{}", value_place.scene, value_place.tracer, value_place.workload, quantity),
                       paper.scene});
  }

  void judge_all() {
    for (const Judged& own : judged_) {
      ReportCell& cell = table_.rows[own.row].cells[own.column];
      std::vector<Peer> peers;
      for (const Judged& other : judged_) {
        if (other.group != own.group || (other.row == own.row && other.column == own.column)) continue;
        const ReportCell& peer = table_.rows[other.row].cells[other.column];
        peers.push_back({peer.published->value, *peer.ours});
      }
      Judgement judgement = judge(*table_.columns[own.column].published, own.scene, cell.published->value, *cell.ours, peers);
      cell.verdict = judgement.verdict;
      cell.reason = joined(cell.reason, judgement.reason);
    }
  }

  /// Conditions of the run, and the machines that absolute values belong to.
  void add_remarks() {
    if (spec_.slopes) {
      table_.remarks.emplace_back(
          "Slopes: the power of the number of triangles with which the value grows, by least squares in logarithms of medians, ± "
          "its "
          "standard error");
    }
    bool timed = false;
    for (const ReportRow& row : table_.rows) {
      for (const ReportCell& cell : row.cells) {
        timed = timed || (cell.ours && cell.value_class != ValueClass::exact);
      }
    }
    if (!timed) return;
    table_.remarks.push_back(fmt::format("Times: median of {} repetition{}, [95 % confidence interval of the median]",
                                         plan_.repetitions, plan_.repetitions == 1 ? "" : "s"));
    std::set<std::string> machines;
    for (const CellResult& result : results_.all()) {
      const auto cpu = result.provenance.find("cpu");
      const auto threads = result.provenance.find("threads");
      if (cpu == result.provenance.end()) continue;
      const std::string count = threads == result.provenance.end() ? "1" : threads->second;
      machines.insert(fmt::format("Machine: {}, {} thread{}", cpu->second, count, count == "1" ? "" : "s"));
      const auto device = result.provenance.find("device");
      if (device != result.provenance.end()) {
        machines.insert(fmt::format("Device: {}, {}", device->second, result.provenance.at("driver")));
      }
    }
    table_.remarks.insert(table_.remarks.end(), machines.begin(), machines.end());
  }

  /// What the paper shows and the experiment cannot: rows whose scene is none of the plan's.
  void add_rows_without_scene() {
    if (published_ == nullptr) return;
    for (const PublishedScene& scene : published_->scenes) {
      if (std::any_of(plan_.scenes.begin(), plan_.scenes.end(), [&](const SceneSpec& s) { return s.name == scene.ours; })) {
        continue;
      }
      ReportRow row{scene.name, {}};
      bool any = false;
      for (const ReportColumn& column : table_.columns) {
        ReportCell cell;
        cell.absence = not_at_hand;
        cell.reason = scene.ours.empty() ? fmt::format("scene not installed: {}", scene.reason)
                                         : fmt::format("scene not in this experiment: {} is our '{}'", scene.name, scene.ours);
        if (column.published != nullptr && column.published->values.contains(scene.name)) {
          cell.published = column.published->values.at(scene.name);
          cell.value_class = column.published->value_class;
          any = true;
        }
        row.cells.push_back(std::move(cell));
      }
      if (any) table_.rows.push_back(std::move(row));
    }
  }

  const TableSpec& spec_;
  const Plan& plan_;
  const ResultSet& results_;
  const Published* published_;
  ReportTable table_;
  std::vector<Judged> judged_;
  std::map<std::size_t, Contest> contests_;  ///< by column
};

void check_column(const ColumnSpec& column, const TableSpec& table, const Published* published,
                  std::vector<Diagnostic>& problems) {
  if (column.published.empty()) return;
  if (published == nullptr) {
    problems.push_back({column.where,
                        fmt::format("column '{}' has a published value, but the experiment names no paper", column.name),
                        "'paper: NAME' for results/published/NAME.yaml",
                        {}});
    return;
  }
  const PublishedColumn* found = published->find(column.published);
  if (found == nullptr) {
    try {
      (void)published->column(column.published, column.where);
    } catch (const Error& error) {
      problems.push_back(error.diagnostics().front());
    }
    return;
  }
  const bool fits = table.rows == "scene" ? found->rows == PublishedRows::scene : found->rows != PublishedRows::claim;
  if (!fits) {
    problems.push_back({column.where,
                        fmt::format("published value '{}' is not given by {}", column.published, table.rows),
                        fmt::format("one whose rows are {}s", table.rows),
                        {}});
  }
  if (!column.unit.empty() && unit_factor(column.unit, found->unit) != 1.0) {
    problems.push_back({column.where,
                        fmt::format("column '{}' is shown in '{}'", column.name, column.unit),
                        fmt::format("'{}', the unit of the published '{}'", found->unit, column.published),
                        {}});
  }
}

}  // namespace

const CellResult* ResultSet::find(std::string_view scene, std::string_view method, std::string_view tracer,
                                  std::string_view workload) const {
  const auto found = std::find_if(results_.begin(), results_.end(), [&](const CellResult& r) {
    return r.scene == scene && r.method == method && r.tracer == tracer && r.workload == workload;
  });
  return found == results_.end() ? nullptr : &*found;
}

bool ReportTable::has_published() const {
  return std::any_of(columns.begin(), columns.end(), [](const ReportColumn& c) { return c.published != nullptr; });
}

bool ReportTable::has_targets() const {
  return std::any_of(rows.begin(), rows.end(), [](const ReportRow& row) {
    return std::any_of(row.cells.begin(), row.cells.end(), [](const ReportCell& c) { return c.target.has_value(); });
  });
}

std::optional<Published> published_of(const Plan& plan) {
  namespace fs = std::filesystem;
  if (plan.paper.empty()) return {};
  const fs::path name = fs::path("published") / (plan.paper + ".yaml");
  const std::vector<fs::path> places{fs::path(plan.file).parent_path() / ".." / "results" / name,
                                     fs::path(RAYSTUDY_SOURCE_RESULTS) / name, fs::path(RAYSTUDY_INSTALLED_RESULTS) / name};
  for (const fs::path& place : places) {
    if (fs::exists(place)) return read_published(place.lexically_normal());
  }
  throw Error(Diagnostic{{plan.file, 0, 0},
                         fmt::format("there are no published values of the paper '{}'", plan.paper),
                         fmt::format("the file {}", places.front().lexically_normal().string()),
                         {}});
}

void check_tables(const Plan& plan, const Published* published) {
  std::vector<Diagnostic> problems;
  for (const TableSpec& table : plan.tables) {
    for (const ColumnSpec& column : table.columns) check_column(column, table, published, problems);
  }
  if (!problems.empty()) throw Error(std::move(problems));
}

std::vector<ReportTable> build_tables(const Plan& plan, const ResultSet& results, const Published* published) {
  check_tables(plan, published);
  std::vector<ReportTable> tables;
  for (const TableSpec& spec : plan.tables) {
    if (spec.rows == "scene" || !spec.scene.empty()) {
      tables.push_back(TableBuilder(spec, plan, results, published).build(spec.scene));
      continue;
    }
    for (const std::string& scene : spec.slopes ? scene_bases(plan, {}) : labels_of(plan.scenes)) {
      tables.push_back(TableBuilder(spec, plan, results, published).build(scene));
    }
  }
  return tables;
}

}  // namespace raystudy
