#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "harness/run/memory.h"
#include "harness/run/thread_limit.h"
#include "harness/run/worker_steps.h"
#include "harness/spec/quantity.h"

namespace raystudy {
namespace {

/// Places in Lap::parts: build, encode, upload, download, each optimizer, each part of the device's time.
constexpr std::size_t upload_part = 2;
constexpr std::size_t optimize_part = 4;

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

/// That of the build which took the median time: builds of one method take the same steps, each in its own time.
std::vector<CostSample> middle_trace(std::vector<std::vector<CostSample>>& traces) {
  if (traces.empty()) return {};
  const auto middle = traces.begin() + static_cast<std::ptrdiff_t>(traces.size() / 2);
  std::nth_element(traces.begin(), middle, traces.end(),
                   [](const auto& a, const auto& b) { return a.back().seconds < b.back().seconds; });
  return *middle;
}

}  // namespace

TimedWork Worker::timed_build(PipelineWork& work) {
  const std::size_t cell = *work.build_cell;
  TimedWork timed_work;
  timed_work.name = plan_.pipelines[work.index].label + "/build";
  timed_work.run_once = [this, cell, &work] {
    const MemoryLimit limit(plan_.memory_limit_bytes);
    std::vector<CostSample> trace;
    BuildContext context = context_of(work);
    context.cost_trace = &trace;
    const ThreadLimit threads(context.threads);
    StageTimes times;
    std::unique_ptr<Accel> accel =
        work.pipeline->run(*scene_, context, times, [this, cell](std::string_view stage) { announce(Scope::cell, cell, stage); });
    board_.add_time(Spent::measured, times.total() + times.device.upload + times.device.download);
    const double built = Board::now_seconds();
    accel.reset();
    if (!trace.empty()) work.cost_traces.push_back(std::move(trace));
    board_.add_time(Spent::set_up, Board::now_seconds() - built);
    return lap_of(times, times.total());
  };
  timed_work.finished = [this, cell, &work](const std::vector<TimedSample>& samples) {
    add_stage_times(work, samples);
    add_cost_trace(work.build_result, middle_trace(work.cost_traces));
    send(cell, work.build_result);
  };
  return timed_work;
}

Lap Worker::lap_of(const StageTimes& times, double seconds) {
  Lap lap{seconds, {times.build, times.encode, times.device.upload, times.device.download}};
  lap.parts.insert(lap.parts.end(), times.optimize.begin(), times.optimize.end());
  for (const DeviceTimes::Part& part : times.device.parts) lap.parts.push_back(part.seconds);
  return lap;
}

/// What only methods have that work on a device.
void Worker::add_device_times(PipelineWork& work, const std::vector<TimedSample>& samples) {
  const DeviceTimes& device = work.first_times.device;
  const std::size_t parts = optimize_part + work.pipeline->optimizer_names().size() + device.parts.size();
  // Before an animation is played nothing may have been built, though the device has built since.
  if (!device.seconds || samples.front().parts.size() != parts) return;
  CellResult& result = work.build_result;
  const auto add = [&](const std::string& name, std::size_t part) {
    result.values[name] = timed("s", samples, [part](const TimedSample& s) { return s.parts.at(part); });
  };
  add("upload_time", upload_part);
  add("download_time", upload_part + 1);
  for (std::size_t i = 0; i < device.parts.size(); ++i) {
    add(build_part_quantity(device.parts[i].name), optimize_part + work.pipeline->optimizer_names().size() + i);
  }
  result.values["device_memory"] = {ValueClass::absolute, "bytes", {static_cast<double>(device.peak_bytes)}};
  if (device.levels.empty()) return;
  Series time{"level", "1", "s", {}, {}};
  Series active{"level", "1", "1", {}, {}};
  for (std::size_t i = 0; i < device.levels.size(); ++i) {
    for (Series* series : {&time, &active}) series->x.push_back(static_cast<double>(i + 1));
    time.y.push_back(device.levels[i].seconds);
    active.y.push_back(device.levels[i].active);
  }
  result.series["level_time"] = std::move(time);
  result.series["level_active"] = std::move(active);
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
    result.values["optimize_time"] = timed("s", samples, [&names](const TimedSample& s) {
      const auto first = s.parts.begin() + optimize_part;
      return std::accumulate(first, first + static_cast<std::ptrdiff_t>(names.size()), 0.0);
    });
  }
  for (std::size_t i = 0; names.size() > 1 && i < names.size(); ++i) {
    result.values["optimize_time:" + names[i]] = part(optimize_part + i);
  }
  add_device_times(work, samples);
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
    return Lap{trace_seconds(*trace.session, seconds), {}};
  };
  timed_work.finished = [this, &trace](const std::vector<TimedSample>& samples) {
    const auto count = static_cast<double>(trace.rays->batch.rays.size());
    trace.result.values["trace_time"] = timed("s", samples, [](const TimedSample& s) { return s.seconds; });
    trace.result.values["trace_rate"] = timed("rays/s", samples, [count](const TimedSample& s) { return count / s.seconds; });
    add_common_times(trace.result, samples);
    send(trace.cell, trace.result);
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
