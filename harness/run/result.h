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
  [[nodiscard]] double median() const;
};

/// A quantity over an axis: area sums by depth, cost over seconds.
struct Series {
  std::string x_name;
  std::string x_unit;
  std::string unit;
  std::vector<double> x;
  std::vector<double> y;
};

/// done: measured. failed: crashed, timed out, ran out of memory or gave a wrong hit; `reason` says which. missing: something a
/// user can supply is not there (a scene).
enum class CellStatus : unsigned char { done, failed, missing };

/// One cell's immutable result: results/<experiment>/<id>.json.
struct CellResult {
  std::string id;          ///< hash of everything that can change the numbers (Cell::id)
  std::string experiment;  ///< the YAML's file name without extension
  std::string scene;
  std::string method;      ///< with its sweep point, e.g. "insertion[batch=2]"
  std::string tracer;      ///< empty in a build cell
  std::string workload;    ///< empty in a build cell
  CellStatus status = CellStatus::done;
  std::string reason;
  std::map<std::string, Measurement> values;     ///< by metric name, e.g. cost, build_time, trace_rate
  std::map<std::string, Series> series;
  std::map<std::string, std::string> provenance;  ///< commit, compiler, flags, versions, cpu, kernel, threads, scene hash, seed, command…
};

/// Writes `<folder>/<id>.json` atomically (temporary file, fsync, rename). Throws Error naming the path and the system's reason.
void write_result(const std::filesystem::path& folder, const CellResult& result);
/// Throws Error naming the file and what is wrong with it.
[[nodiscard]] CellResult read_result(const std::filesystem::path& file);

}  // namespace raystudy
