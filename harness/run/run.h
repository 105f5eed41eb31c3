#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "harness/run/result.h"
#include "harness/run/worker.h"
#include "harness/spec/plan.h"

namespace raystudy {

struct RunOptions {
  std::filesystem::path results = "results";  ///< the experiment's own folder is made in it
  bool force = false;                         ///< measure what is measured already
  std::string command;                        ///< the command line, for the results' provenance
  OpenScene open;                             ///< how scenes are opened; empty: open_scene
  double sample_seconds = 0.02;               ///< shorter work is iterated within a repetition (timing.h); less only in tests
  std::FILE* log = stderr;                    ///< progress and notes
};

/// How a study went, and where its wall-clock time went, in seconds.
struct RunSummary {
  std::size_t done = 0;
  std::size_t failed = 0;
  std::size_t missing = 0;
  std::size_t reused = 0;  ///< measured by an earlier run
  std::size_t left = 0;    ///< not measured, since the run was interrupted
  bool interrupted = false;
  double wall = 0;
  double measured = 0;  ///< inside timed builds and traces
  double warm_up = 0;   ///< the first build of each method, which gives the exact numbers
  double set_up = 0;    ///< opening scenes, making rays, freeing structures
  double checks = 0;    ///< validating trees, metrics, reference hits, checking hits, counting
  [[nodiscard]] double harness() const { return wall - measured - warm_up - set_up - checks; }
  /// Two lines: cells, then time.
  [[nodiscard]] std::string text() const;
};

/// Measures the cells of `plan` that have no result yet; those that failed before are tried again.
///
/// Each scene is measured by a process of its own (worker.h). Where it crashes, takes longer than the plan's timeout over a
/// cell or over opening the scene, or is killed for memory, the cell at work gets a failed result that says so and a new process
/// goes on with the others. Every result is on disk before the next is begun, so that whatever ends the run, the same command
/// goes on where it was. SIGINT, SIGTERM and SIGHUP end it at once, with `interrupted` set. The calling process must have one
/// thread only.
///
/// Throws Error, before anything is measured, where the results folder cannot be written; later where a result cannot be
/// written (a full disk), after ending the worker.
[[nodiscard]] RunSummary run_plan(const Plan& plan, const RunOptions& options);

/// The results of the plan's cells that are in its folder, in the order of the cells. Throws one Error with all that cannot be
/// read.
[[nodiscard]] std::vector<CellResult> read_results(const Plan& plan, const std::filesystem::path& results);

/// `<results>/<plan's name>`.
[[nodiscard]] std::filesystem::path results_folder(const Plan& plan, const std::filesystem::path& results);

}  // namespace raystudy
