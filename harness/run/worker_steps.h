#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "harness/method/method.h"
#include "harness/run/board.h"
#include "harness/run/message.h"
#include "harness/run/oracle.h"
#include "harness/run/pipeline.h"
#include "harness/run/result.h"
#include "harness/run/timing.h"
#include "harness/run/worker.h"

namespace raystudy {

/// A method's result is wrong: reported as it is, without "error while".
class WrongResult : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[nodiscard]] Measurement exact(std::string unit, double value);
/// The counts of a counting pass, a ray.
void add_counts(CellResult& result, const TraceCounts& counts, double rays);
/// The samples of optimizers as a series over seconds; nothing where there are none.
void add_cost_trace(CellResult& result, const std::vector<CostSample>& trace);
/// How long the last trace took: `seconds` by the wall clock, or what the device measured.
[[nodiscard]] double trace_seconds(const TraceSession& session, double seconds);
/// Throws WrongResult where find_problems finds something.
void require_valid(const Accel& accel, const Scene& scene);
/// Throws WrongResult where a hit is wrong; the first one is enough for a row's reason.
void require_right(OracleReport report, const RayBatch& batch);

struct Rays {
  RayBatch batch;
  std::vector<Hit> reference;  ///< Embree's
};

struct TraceWork {
  std::size_t cell = 0;
  const Rays* rays = nullptr;
  std::unique_ptr<Tracer> tracer;
  std::unique_ptr<TraceSession> session;
  CellResult result;
};

/// A pipeline and its cells that are to be measured.
struct PipelineWork {
  std::size_t index = 0;
  std::optional<std::size_t> build_cell;
  std::vector<std::size_t> trace_cells;
  std::unique_ptr<Pipeline> pipeline;
  StageTimes first_times;  ///< of the build that is not timed
  CellResult build_result;
  std::vector<std::vector<CostSample>> cost_traces;  ///< of each timed build, where it optimizes
  std::unique_ptr<Accel> accel;  ///< kept where it is traced
  std::vector<std::unique_ptr<TraceWork>> traces;
};

/// What run_worker (worker.h) does, step by step.
class Worker {
 public:
  Worker(const Plan& plan, std::vector<std::size_t> cells, const WorkerOptions& options, Board& board,
         const MessageSender& sender)
      : plan_(plan), cells_(std::move(cells)), options_(options), board_(board), sender_(sender) {}

  void run();

 private:
  friend class AnimationRun;

  bool guarded(Spent kind, Scope scope, std::size_t index, std::string_view stage, const std::function<void()>& work);
  void announce(Scope scope, std::size_t index, std::string_view stage);
  void fail(Scope scope, std::size_t index, std::string_view stage, const std::exception_ptr& error);

  void send(std::size_t cell, CellResult& result) const;
  void open_the_scene();
  [[nodiscard]] std::set<std::size_t> workloads() const;
  void make_rays(const Scene& scene, const std::set<std::size_t>& wanted);
  void build(PipelineWork& work);
  void measure_tree(PipelineWork& work, const Accel& accel, const Scene& scene);
  void check_trace(PipelineWork& work, std::size_t cell);
  void run_group_by_group();
  void time_group(std::vector<std::unique_ptr<PipelineWork>>& group);
  void time_all(std::vector<TimedWork> works);
  TimedWork timed_build(PipelineWork& work);
  static Lap lap_of(const StageTimes& times, double seconds);
  void add_stage_times(PipelineWork& work, const std::vector<TimedSample>& samples);
  static void add_device_times(PipelineWork& work, const std::vector<TimedSample>& samples);
  TimedWork timed_trace(const PipelineWork& work, TraceWork& trace);
  [[nodiscard]] std::vector<std::unique_ptr<PipelineWork>> pipelines() const;
  [[nodiscard]] BuildContext context_of(const PipelineWork& work) const;

  const Plan& plan_;
  std::vector<std::size_t> cells_;
  const WorkerOptions& options_;
  Board& board_;
  const MessageSender& sender_;
  std::optional<Scene> scene_;
  BuildContext context_;  ///< with the experiment's threads
  std::unique_ptr<ReferenceTracer> reference_;
  std::unique_ptr<Oracle> oracle_;
  std::map<std::size_t, Rays> rays_;  ///< by workload
  std::vector<Hit> hits_;             ///< of the trace that is being timed
  std::map<std::pair<Scope, std::size_t>, double> spent_;
  std::pair<Scope, std::size_t> current_{Scope::scene, 0};
  std::string current_stage_;
  double current_start_ = 0;
};

}  // namespace raystudy
