#include <fmt/format.h>

#include <numeric>

#include "harness/run/memory.h"
#include "harness/run/thread_limit.h"
#include "harness/run/worker_steps.h"

namespace raystudy {
namespace {

/// One sample from each repetition.
template <class Get>
Measurement timed(std::string unit, const std::vector<TimedSample>& samples, Get get) {
  Measurement m{ValueClass::absolute, std::move(unit), {}};
  for (const TimedSample& sample : samples) m.samples.push_back(get(sample));
  return m;
}

void add_common_times(CellResult& result, const std::vector<TimedSample>& samples) {
  result.values["cpu_time"] = timed("s", samples, [](const TimedSample& s) { return s.cpu_seconds; });
  result.values["iterations"] = timed("1", samples, [](const TimedSample& s) { return s.iterations; });
}

}  // namespace

TimedWork Worker::timed_build(PipelineWork& work) {
  const std::size_t cell = *work.build_cell;
  TimedWork timed_work;
  timed_work.name = plan_.pipelines[work.index].label + "/build";
  timed_work.run_once = [this, cell, &work] {
    const MemoryLimit limit(plan_.memory_limit_bytes);
    const BuildContext context = context_of(work);
    const ThreadLimit threads(context.threads);
    StageTimes times;
    std::unique_ptr<Accel> accel =
        work.pipeline->run(*scene_, context, times, [this, cell](std::string_view stage) { announce(Scope::cell, cell, stage); });
    board_.add_time(Spent::measured, times.total());
    const double built = Board::now_seconds();
    accel.reset();
    board_.add_time(Spent::set_up, Board::now_seconds() - built);
    return lap_of(times, times.total());
  };
  timed_work.finished = [this, cell, &work](const std::vector<TimedSample>& samples) {
    add_stage_times(work, samples);
    sender_.send(CellMeasured{cell, work.build_result});
  };
  return timed_work;
}

Lap Worker::lap_of(const StageTimes& times, double seconds) {
  Lap lap{seconds, {times.build, times.encode}};
  lap.parts.insert(lap.parts.end(), times.optimize.begin(), times.optimize.end());
  return lap;
}

void Worker::add_stage_times(PipelineWork& work, const std::vector<TimedSample>& samples) {
  CellResult& result = work.build_result;
  const auto part = [&samples](std::size_t i) {
    return timed("s", samples, [i](const TimedSample& s) { return s.parts.at(i); });
  };
  result.values["build_time"] = part(0);
  if (work.pipeline->has_encoder() && !plan_.animation) result.values["encode_time"] = part(1);
  const std::vector<std::string>& names = work.pipeline->optimizer_names();
  if (!names.empty()) {
    result.values["optimize_time"] =
        timed("s", samples, [](const TimedSample& s) { return std::accumulate(s.parts.begin() + 2, s.parts.end(), 0.0); });
  }
  for (std::size_t i = 0; names.size() > 1 && i < names.size(); ++i) result.values["optimize_time:" + names[i]] = part(2 + i);
  result.values["total_time"] = timed("s", samples, [](const TimedSample& s) { return s.seconds; });
  add_common_times(result, samples);
}

TimedWork Worker::timed_trace(const PipelineWork& work, TraceWork& trace) {
  const Cell& cell = plan_.cells[trace.cell];
  TimedWork timed_work;
  timed_work.name = fmt::format("{}/{}/{}", plan_.pipelines[work.index].label, plan_.tracers[*cell.tracer].label,
                                plan_.workloads[*cell.workload].label);
  timed_work.run_once = [this, &trace, threads = plan_.pipelines[work.index].threads] {
    announce(Scope::cell, trace.cell, "tracing");
    const MemoryLimit limit(plan_.memory_limit_bytes);
    const ThreadLimit thread_limit(threads);
    const RayBatch& batch = trace.rays->batch;
    const std::span<Hit> hits(hits_.data(), batch.rays.size());
    const double start = Board::now_seconds();
    trace.session->trace(batch.rays, hits, batch.query);
    const double seconds = Board::now_seconds() - start;
    board_.add_time(Spent::measured, seconds);
    return Lap{seconds, {}};
  };
  timed_work.finished = [this, &trace](const std::vector<TimedSample>& samples) {
    const auto count = static_cast<double>(trace.rays->batch.rays.size());
    trace.result.values["trace_time"] = timed("s", samples, [](const TimedSample& s) { return s.seconds; });
    trace.result.values["trace_rate"] = timed("rays/s", samples, [count](const TimedSample& s) { return count / s.seconds; });
    add_common_times(trace.result, samples);
    sender_.send(CellMeasured{trace.cell, trace.result});
  };
  return timed_work;
}

void Worker::time_group(std::vector<std::unique_ptr<PipelineWork>>& group) {
  std::vector<TimedWork> works;
  const auto add = [this, &works](std::size_t cell, TimedWork work) {
    work.failed = [this, cell](const std::exception_ptr& error) { fail(Scope::cell, cell, current_stage_, error); };
    works.push_back(std::move(work));
  };
  for (const auto& work : group) {
    if (work->build_cell) add(*work->build_cell, timed_build(*work));
    for (const auto& trace : work->traces) add(trace->cell, timed_trace(*work, *trace));
  }
  time_all(std::move(works));
  const double timed = Board::now_seconds();
  group.clear();
  board_.add_time(Spent::set_up, Board::now_seconds() - timed);
}

void Worker::time_all(std::vector<TimedWork> works) {
  TimingOptions options;
  options.repetitions = plan_.repetitions;
  options.sample_seconds = options_.sample_seconds;
  options.warm_up_seconds = plan_.warm_up_seconds;
  options.on_repetition = [this] { board_.count_repetition(); };
  time_interleaved(std::move(works), options);
}

}  // namespace raystudy
