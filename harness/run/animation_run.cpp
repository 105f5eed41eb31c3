#include "harness/run/animation_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "harness/method/tree_figures.h"
#include "harness/run/memory.h"
#include "harness/run/thread_limit.h"
#include "harness/scene/animation.h"

namespace raystudy {
namespace {

Series by_frame(std::string unit, std::vector<double> values) {
  Series series{"frame", "1", std::move(unit), {}, std::move(values)};
  for (std::size_t i = 0; i < series.y.size(); ++i) series.x.push_back(static_cast<double>(i));
  return series;
}

/// One sample a repetition, made of its frames' values.
template <class Reduce>
Measurement reduced(std::string unit, const std::vector<std::vector<double>>& passes, Reduce reduce) {
  Measurement m{ValueClass::absolute, std::move(unit), {}};
  for (const std::vector<double>& frames : passes) m.samples.push_back(reduce(frames));
  return m;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }
double mean(const std::vector<double>& values) { return sum(values) / static_cast<double>(values.size()); }
double greatest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

/// By frame the median over the repetitions.
std::vector<double> medians(const std::vector<std::vector<double>>& passes) {
  std::vector<double> result(passes.front().size());
  for (std::size_t f = 0; f < result.size(); ++f) {
    Measurement m;
    for (const std::vector<double>& frames : passes) m.samples.push_back(frames[f]);
    result[f] = m.median();
  }
  return result;
}

double bytes_of(const Rays& rays) {
  return static_cast<double>(rays.batch.rays.size() * sizeof(Ray) + rays.batch.ray_pixels.size() * sizeof(std::uint32_t));
}

}  // namespace

AnimationRun::AnimationRun(Worker& worker, std::size_t frames)
    : worker_(worker), times_(uniform_times(frames)), workloads_(worker.workloads()), kept_(frames) {}

std::unique_ptr<UpdateSession> AnimationRun::prepare(const Played& played, StageTimes& times, std::vector<CostSample>* trace) {
  const PipelineWork& work = *played.work;
  BuildContext context = worker_.context_of(work);
  context.cost_trace = trace;
  return prepare_updates(*work.pipeline, worker_.plan_.pipelines[work.index], *worker_.scene_, times_, context, times);
}

void AnimationRun::prepare_all() {
  for (const std::size_t w : workloads_) worker_.rays_[w];  // no workload has failed yet
  for (auto& work : worker_.pipelines()) {
    auto played = std::make_unique<Played>();
    played->work = std::move(work);
    const std::size_t index = played->work->index;
    const bool ready = worker_.guarded(Spent::warm_up, Scope::pipeline, index, "building", [&] {
      const PipelineSpec& spec = worker_.plan_.pipelines[index];
      played->work->pipeline = std::make_unique<Pipeline>(spec);
      const ThreadLimit limit(spec.threads);
      const PeakMemory peak;
      std::vector<CostSample> trace;
      played->session = prepare(*played, played->work->first_times, &trace);
      CellResult& result = played->work->build_result;
      if (const std::optional<double> bytes = peak.bytes()) {
        result.values["peak_memory"] = {ValueClass::absolute, "bytes", {*bytes}};
      }
      result.values["triangles"] = exact("1", static_cast<double>(worker_.scene_->triangles.size()));
      add_cost_trace(result, trace);
      for (const std::size_t cell : played->work->trace_cells) {
        Traced traced;
        traced.cell = cell;
        traced.tracer = Registry::instance().create<Tracer>(worker_.plan_.tracers[*worker_.plan_.cells[cell].tracer].tracer);
        played->traces.push_back(std::move(traced));
      }
    });
    if (ready) methods_.push_back(std::move(played));
  }
}

/// Rays are kept from one pass to the next as long as they take no more than a quarter of the free memory.
std::shared_ptr<AnimationRun::FrameRays> AnimationRun::frame_rays(std::size_t frame) {
  if (kept_[frame]) return kept_[frame];
  auto rays = std::make_shared<FrameRays>();
  rays->scene = scene_at(*worker_.scene_, times_[frame]);
  worker_.make_rays(rays->scene, workloads_);
  std::erase_if(workloads_, [this](std::size_t w) { return !worker_.rays_.contains(w); });
  for (auto& played : methods_) {
    for (Traced& trace : played->traces) {
      if (!workloads_.contains(*worker_.plan_.cells[trace.cell].workload)) trace.failed = true;
    }
  }
  rays->rays = std::move(worker_.rays_);
  auto bytes = static_cast<double>(rays->scene.vertices.size() * sizeof(Vec3));
  for (const auto& [w, one] : rays->rays) bytes += bytes_of(one);
  if (kept_bytes_ + bytes < available_memory() / 4) {
    kept_bytes_ += bytes;
    kept_[frame] = rays;
  }
  return rays;
}

void AnimationRun::check_trace(Traced& trace, const Accel& accel, const FrameRays& frame, int threads) {
  const Rays& rays = frame.rays.at(*worker_.plan_.cells[trace.cell].workload);
  const RayBatch& batch = rays.batch;
  const auto session = trace.tracer->prepare(accel, frame.scene, threads, batch.coherent);
  std::vector<Hit> hits(batch.rays.size());
  session->trace(batch.rays, hits, batch.query);
  const OracleReport report = worker_.oracle_->check(batch.rays, hits, rays.reference, batch.query, session->watertight());
  require_right(report, batch);
  if (!session->watertight()) trace.leaks = trace.leaks.value_or(0) + static_cast<double>(report.leaks);
  trace.rays.push_back(static_cast<double>(batch.rays.size()));
  trace.hits += static_cast<double>(std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); }));
  if (!session->counts()) return;
  const TraceCounts counts = session->count(batch.rays, batch.query, {});
  if (!trace.counts) trace.counts.emplace();
  trace.counts->inner_nodes += counts.inner_nodes;
  trace.counts->leaves += counts.leaves;
  trace.counts->box_tests += counts.box_tests;
  trace.counts->triangle_tests += counts.triangle_tests;
}

void AnimationRun::time_trace(Traced& trace, const Accel& accel, const FrameRays& frame, int threads, std::size_t repetition) {
  const RayBatch& batch = frame.rays.at(*worker_.plan_.cells[trace.cell].workload).batch;
  const auto session = trace.tracer->prepare(accel, frame.scene, threads, batch.coherent);
  const std::span<Hit> hits(worker_.hits_.data(), batch.rays.size());
  const double cpu_start = process_cpu_seconds();
  const double start = Board::now_seconds();
  session->trace(batch.rays, hits, batch.query);
  trace.seconds[repetition].push_back(trace_seconds(*session, Board::now_seconds() - start));
  trace.cpu_seconds[repetition].push_back(process_cpu_seconds() - cpu_start);
}

/// The pass of checks and exact numbers.
void AnimationRun::check_frame(Played& played, const Accel& tree, const Accel& accel, const FrameRays& rays, std::size_t frame) {
  require_valid(tree, rays.scene);
  if (&tree != &accel) require_valid(accel, rays.scene);
  if (tree.kind() == Bvh2::kind_name || tree.kind() == WideBvh::kind_name) {
    played.costs.push_back(tree_figures(tree, worker_.context_.cost).cost);
  }
  if (frame == 0) worker_.measure_tree(*played.work, accel, rays.scene);
}

void AnimationRun::play_frame(Played& played, FrameRays& rays, std::size_t frame, std::optional<std::size_t> repetition) {
  const std::size_t index = played.work->index;
  const int threads = worker_.plan_.pipelines[index].threads;
  const Spent kind = repetition ? Spent::measured : Spent::checks;
  FrameUpdate update;
  std::unique_ptr<Accel> encoded;
  const ThreadLimit limit(threads);
  const bool updated = worker_.guarded(kind, Scope::pipeline, index, "updating", [&] {
    StageTimes times;
    const double not_counted = played.work->first_times.not_counted;
    const double start = Board::now_seconds();
    update = played.session->update(rays.scene, frame);
    const double passed = Board::now_seconds() - start - (played.work->first_times.not_counted - not_counted);
    const double seconds = update.device_seconds.value_or(passed);
    if (played.work->pipeline->has_encoder()) {
      encoded = played.work->pipeline->encode(*update.accel, rays.scene, worker_.context_of(*played.work), times);
    }
    if (repetition) played.seconds[*repetition].push_back(seconds + times.encode);
  });
  const Accel* accel = encoded ? encoded.get() : update.accel;
  const bool right = updated && (repetition || worker_.guarded(kind, Scope::pipeline, index, "checking the tree", [&] {
                       played.rebuilt.push_back(update.rebuilt ? 1 : 0);
                       check_frame(played, *update.accel, *accel, rays, frame);
                     }));
  if (!right) {
    played.failed = true;
    return;
  }
  for (Traced& trace : played.traces) {
    if (trace.failed) continue;
    trace.failed = !worker_.guarded(kind, Scope::cell, trace.cell, "tracing", [&] {
      if (repetition) {
        time_trace(trace, *accel, rays, threads, *repetition);
      } else {
        check_trace(trace, *accel, rays, threads);
      }
    });
  }
}

void AnimationRun::play(std::optional<std::size_t> repetition) {
  std::mt19937_64 random(worker_.plan_.seed + (repetition ? *repetition + 1 : 0));
  for (std::size_t frame = 0; frame < times_.size(); ++frame) {
    const std::shared_ptr<FrameRays> rays = frame_rays(frame);
    std::shuffle(methods_.begin(), methods_.end(), random);
    for (auto& played : methods_) {
      if (!played->failed) play_frame(*played, *rays, frame, repetition);
    }
    for (auto& [w, one] : rays->rays) one.reference = {};  // only the first pass checks
  }
  std::erase_if(methods_, [](const auto& played) { return played->failed; });
  for (auto& played : methods_) std::erase_if(played->traces, [](const Traced& trace) { return trace.failed; });
}

void AnimationRun::add_frame_values(Played& played) const {
  CellResult& result = played.work->build_result;
  if (!played.costs.empty()) {
    result.values["average_cost"] = exact("1", mean(played.costs));
    result.values["maximum_cost"] = exact("1", greatest(played.costs));
    result.series["frame_cost"] = by_frame("1", played.costs);
  }
  result.values["rebuilds"] = exact("1", sum(played.rebuilt));
  std::vector<double> so_far(played.rebuilt.size());
  std::partial_sum(played.rebuilt.begin(), played.rebuilt.end(), so_far.begin());
  result.series["frame_rebuilds"] = by_frame("1", so_far);
  result.values["tree_memory"] = exact("bytes", static_cast<double>(played.session->bytes()));
  result.values["update_time"] = reduced("s", played.seconds, mean);
  result.values["maximum_update_time"] = reduced("s", played.seconds, greatest);
  result.series["frame_update_time"] = by_frame("s", medians(played.seconds));
}

void AnimationRun::send_traces(Played& played) {
  for (Traced& trace : played.traces) {
    CellResult& result = trace.result;
    const double rays = sum(trace.rays);
    Passes totals = trace.seconds;
    for (std::size_t r = 0; r < totals.size(); ++r) {
      for (std::size_t f = 0; f < totals[r].size(); ++f) totals[r][f] += played.seconds[r][f];
    }
    result.values["ray_count"] = exact("1", rays);
    result.values["hit_share"] = exact("1", trace.hits / rays);
    if (trace.leaks) result.values["leaks"] = exact("1", *trace.leaks);
    if (trace.counts) add_counts(result, *trace.counts, rays);
    result.values["cpu_time"] = reduced("s", trace.cpu_seconds, sum);
    result.values["iterations"] = reduced("1", trace.seconds, [](const auto&) { return 1.0; });
    result.values["trace_time"] = reduced("s", trace.seconds, sum);
    result.values["trace_rate"] = reduced("rays/s", trace.seconds, [rays](const auto& frames) { return rays / sum(frames); });
    result.values["frame_time"] = reduced("s", totals, mean);
    result.values["maximum_frame_time"] = reduced("s", totals, greatest);
    result.values["frame_rate"] = reduced("frames/s", totals, [](const auto& frames) { return 1 / mean(frames); });
    const std::vector<double> tracing = medians(trace.seconds);
    std::vector<double> rates;
    for (std::size_t f = 0; f < tracing.size(); ++f) rates.push_back(trace.rays[f] / tracing[f]);
    result.series["frame_trace_time"] = by_frame("s", tracing);
    result.series["frame_trace_rate"] = by_frame("rays/s", std::move(rates));
    result.series["frame_total_time"] = by_frame("s", medians(totals));
    worker_.send(trace.cell, result);
  }
}

/// The session that was played is given up first: it may hold a tree for every frame.
void AnimationRun::time_preparations() {
  std::vector<TimedWork> works;
  for (auto& played : methods_) {
    played->session.reset();
    if (!played->work->build_cell) continue;
    const std::size_t cell = *played->work->build_cell;
    TimedWork work;
    work.name = worker_.plan_.pipelines[played->work->index].label + "/build";
    work.run_once = [this, cell, &played = *played] {
      worker_.announce(Scope::cell, cell, "building");
      const MemoryLimit limit(worker_.plan_.memory_limit_bytes);
      const ThreadLimit threads(worker_.plan_.pipelines[played.work->index].threads);
      StageTimes times;
      times.optimize.resize(played.work->pipeline->optimizer_names().size());  // even where nothing is built beforehand
      const double start = Board::now_seconds();
      std::unique_ptr<UpdateSession> session = prepare(played, times, nullptr);
      const double seconds = Board::now_seconds() - start;
      worker_.board_.add_time(Spent::measured, seconds);
      return Worker::lap_of(times, seconds);
    };
    work.finished = [this, cell, &played = *played](const std::vector<TimedSample>& samples) {
      worker_.add_stage_times(*played.work, samples);
      worker_.send(cell, played.work->build_result);
    };
    work.failed = [this, cell](const std::exception_ptr& error) {
      worker_.fail(Scope::cell, cell, worker_.current_stage_, error);
    };
    works.push_back(std::move(work));
  }
  worker_.time_all(std::move(works));
}

void AnimationRun::run() {
  prepare_all();
  play(std::nullopt);
  const auto repetitions = static_cast<std::size_t>(worker_.plan_.repetitions);
  for (auto& played : methods_) {
    played->seconds.resize(repetitions);
    for (Traced& trace : played->traces) {
      trace.seconds.resize(repetitions);
      trace.cpu_seconds.resize(repetitions);
    }
  }
  for (std::size_t r = 0; r < repetitions; ++r) {
    play(r);
    for (const auto& played : methods_) {
      for (std::size_t i = 0; i < played->traces.size(); ++i) worker_.board_.count_repetition();
    }
  }
  for (auto& played : methods_) {
    add_frame_values(*played);
    send_traces(*played);
  }
  time_preparations();
}

}  // namespace raystudy
