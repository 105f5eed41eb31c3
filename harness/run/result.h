#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// The three classes of number, never mixed in a table: exact (a pure function of input and seed), ratio (to a baseline
/// interleaved in the same run), absolute (belongs to its machine).
enum class ValueClass : unsigned char { exact, ratio, absolute };
[[nodiscard]] std::string_view value_class_name(ValueClass c);

/// One measured quantity of a cell. An exact value has one sample; a timed one has one a repetition, in the order measured.
struct Measurement {
  ValueClass value_class = ValueClass::exact;
  std::string unit;
  std::vector<double> samples;
  /// The middle sample, or the mean of the two middle ones. NaN without samples.
  [[nodiscard]] double median() const;

  friend bool operator==(const Measurement&, const Measurement&) = default;
};

/// A quantity over an axis: area sums by depth, cost over seconds.
struct Series {
  std::string x_name;
  std::string x_unit;
  std::string unit;
  std::vector<double> x;
  std::vector<double> y;

  friend bool operator==(const Series&, const Series&) = default;
};

/// done: measured. failed: crashed, timed out, ran out of memory or gave a wrong hit; `reason` says which. missing: something a
/// user can supply is not there (a scene).
enum class CellStatus : unsigned char { done, failed, missing };
[[nodiscard]] std::string_view cell_status_name(CellStatus status);

/// One cell's immutable result: results/<experiment>/<id>.json.
///
/// Names of `values` and `series` are the quantities of harness/spec/quantity.h: the harness's own and those of the experiment's
/// metrics. A stage that the pipeline does not have gives no time, a tracer that cannot count gives no counts. Beside them stand
/// `optimize_time:NAME` for each of several optimizers, `build_time:PART` for each part of a builder's time on a device,
/// `cpu_time` (s, of all threads, in one iteration) and `iterations` (how many times the work was repeated within each sample).
struct CellResult {
  std::string id;          ///< hash of everything that can change the numbers (Cell::id)
  std::string experiment;  ///< the YAML's file name without extension
  std::string scene;
  std::string method;    ///< with its sweep point, e.g. "insertion[batch=2]"
  std::string tracer;    ///< empty in a build cell
  std::string workload;  ///< empty in a build cell
  CellStatus status = CellStatus::done;
  std::string reason;
  std::map<std::string, Measurement> values;  ///< by metric name, e.g. cost, build_time, trace_rate
  std::map<std::string, Series> series;
  std::map<std::string, std::string>
      provenance;  ///< commit, compiler, flags, versions, cpu, kernel, threads, scene hash, seed, command…

  friend bool operator==(const CellResult&, const CellResult&) = default;
};

/// `<folder>/<id>.json`.
[[nodiscard]] std::filesystem::path result_file(const std::filesystem::path& folder, std::string_view id);

/// Writes `<folder>/<id>.json` atomically, and durably but for a missing one, which holds nothing measured and is looked for at
/// every run (atomic_file.h). Throws Error naming the path and the system's reason.
///
/// The file is one JSON object: `format` (1), then CellResult's members by their names; `status` is done, failed or missing;
/// `values` maps a name to {class: exact|ratio|absolute, unit, samples: [numbers]}; `series` maps a name to
/// {x_name, x_unit, unit, x: [numbers], y: [numbers]}; `provenance` maps a name to a text.
void write_result(const std::filesystem::path& folder, const CellResult& result);

/// Throws Error naming the file, where known the line and column, and what is wrong with it.
[[nodiscard]] CellResult read_result(const std::filesystem::path& file);

/// The same between texts. `source` stands in for the file in errors.
[[nodiscard]] std::string result_to_json(const CellResult& result);
[[nodiscard]] CellResult result_from_json(std::string_view text, std::string_view source);

}  // namespace raystudy
