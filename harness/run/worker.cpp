#include "harness/run/worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "harness/accel/validate.h"
#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/method/registry.h"
#include "harness/run/animation_run.h"
#include "harness/run/memory.h"
#include "harness/run/thread_limit.h"
#include "harness/run/worker_steps.h"
#include "harness/scene/open.h"
#include "harness/spec/cell_id.h"
#include "harness/vulkan/device.h"

namespace raystudy {
namespace {

std::string out_of_memory(const Plan& plan, std::string_view stage) {
  const std::string text = fmt::format("out of memory while {}", stage);
  return plan.memory_limit_bytes > 0 ? fmt::format("{} (limit {})", text, bytes_text(plan.memory_limit_bytes)) : text;
}

}  // namespace

Measurement exact(std::string unit, double value) { return {ValueClass::exact, std::move(unit), {value}}; }

double trace_seconds(const TraceSession& session, double seconds) {
  const DeviceTimes* device = session.device_times();
  return device != nullptr ? device->seconds.value_or(seconds) : seconds;
}

void add_counts(CellResult& result, const TraceCounts& counts, double rays) {
  const auto a_ray = [rays](std::uint64_t sum) { return exact("1", static_cast<double>(sum) / rays); };
  result.values["steps_per_ray"] = a_ray(counts.traversal_steps());
  result.values["inner_nodes_per_ray"] = a_ray(counts.inner_nodes);
  result.values["leaves_per_ray"] = a_ray(counts.leaves);
  result.values["box_tests_per_ray"] = a_ray(counts.box_tests);
  result.values["triangle_tests_per_ray"] = a_ray(counts.triangle_tests);
}

void add_cost_trace(CellResult& result, const std::vector<CostSample>& trace) {
  if (trace.empty()) return;
  Series series{"seconds", "s", "1", {}, {}};
  for (const CostSample& sample : trace) {
    series.x.push_back(sample.seconds);
    series.y.push_back(sample.cost);
  }
  result.series["cost_over_time"] = std::move(series);
}

void require_valid(const Accel& accel, const Scene& scene) {
  const std::vector<std::string> problems = find_problems(accel, scene, 1);
  if (!problems.empty()) throw WrongResult(fmt::format("wrong tree: {}", problems.front()));
}

void require_right(OracleReport report, const RayBatch& batch) {
  if (report.ok()) return;
  report.examples.resize(1);
  std::string text = report.text(batch.rays, batch.query);
  const std::size_t line = text.find("\n  ");
  throw WrongResult(line == std::string::npos ? text : text.replace(line, 3, ": "));
}

/// Tells the board what comes, and adds what the stage before took to its own account.
void Worker::announce(Scope scope, std::size_t index, std::string_view stage) {
  const double now = Board::now_seconds();
  if (current_start_ > 0) spent_[current_] += now - current_start_;
  current_ = {scope, index};
  current_stage_ = stage;
  current_start_ = now;
  board_.enter({scope, index, spent_[current_], now, current_stage_});
}

void Worker::fail(Scope scope, std::size_t index, std::string_view stage, const std::exception_ptr& error) {
  ScopeFailed message{scope, index, CellStatus::failed, {}};
  try {
    std::rethrow_exception(error);
  } catch (const SceneNotInstalled& missing) {
    message.status = CellStatus::missing;
    message.reason = missing.what();
  } catch (const std::bad_alloc&) {
    message.reason = out_of_memory(plan_, stage);
  } catch (const WrongResult& wrong) {
    message.reason = wrong.what();
  } catch (const std::exception& other) {
    message.reason = fmt::format("error while {}: {}", stage, other.what());
  } catch (...) {
    message.reason = fmt::format("error while {}: an exception that is no std::exception", stage);
  }
  sender_.send(message);
}

/// Runs `work` under the memory limit; where it throws, the cells in scope fail and false is returned.
bool Worker::guarded(Spent kind, Scope scope, std::size_t index, std::string_view stage, const std::function<void()>& work) {
  announce(scope, index, stage);
  const double start = Board::now_seconds();
  std::exception_ptr error;
  try {
    const MemoryLimit limit(scope == Scope::scene ? 0 : plan_.memory_limit_bytes);
    work();
  } catch (...) {
    error = std::current_exception();
  }
  board_.add_time(kind, Board::now_seconds() - start);
  if (error) fail(scope, index, current_stage_, error);
  return !error;
}

void Worker::open_the_scene() {
  const std::size_t index = plan_.cells[cells_.front()].scene;
  scene_ = options_.open(plan_.scenes[index]);
  context_.threads = plan_.threads;
  context_.seed = plan_.seed;
  announce(Scope::scene, index, "preparing the cost model");
  context_.cost = make_cost_model(plan_.cost, *scene_, plan_.threads, plan_.seed);
}

std::set<std::size_t> Worker::workloads() const {
  std::set<std::size_t> wanted;
  for (const std::size_t c : cells_) {
    if (plan_.cells[c].workload) wanted.insert(*plan_.cells[c].workload);
  }
  return wanted;
}

void Worker::make_rays(const Scene& scene, const std::set<std::size_t>& wanted) {
  reference_.reset();
  oracle_.reset();
  rays_.clear();
  for (const std::size_t w : wanted) {
    const bool made = guarded(Spent::set_up, Scope::workload, w, "making the rays", [this, w, &scene] {
      if (!reference_) reference_ = std::make_unique<ReferenceTracer>(scene, plan_.threads);
      if (!oracle_) oracle_ = std::make_unique<Oracle>(scene);
      WorkloadContext context;
      context.seed = plan_.seed;
      context.closest_hits = [this](std::span<const Ray> rays, std::span<Hit> hits) {
        reference_->trace(rays, hits, Query::closest_hit);
      };
      Rays& rays = rays_[w];
      rays.batch = Registry::instance().create<Workload>(plan_.workloads[w].workload)->generate(scene, context);
      if (rays.batch.rays.empty()) throw Error(fmt::format("workload '{}' made no rays", plan_.workloads[w].label));
      rays.reference.resize(rays.batch.rays.size());
    });
    if (!made) {
      rays_.erase(w);
      continue;
    }
    Rays& rays = rays_[w];
    if (!guarded(Spent::checks, Scope::workload, w, "tracing the reference",
                 [&] { reference_->trace(rays.batch.rays, rays.reference, rays.batch.query); })) {
      rays_.erase(w);
      continue;
    }
    hits_.resize(std::max(hits_.size(), rays.batch.rays.size()));
  }
}

/// The parent knows all of the result's provenance but the device: it must not open one, for its children would inherit it.
void Worker::send(std::size_t cell, CellResult& result) const {
  const vulkan::DeviceInfo* device = vulkan::Device::shared_info();
  if (device != nullptr && uses_device(plan_, plan_.cells[cell])) {
    result.provenance["device"] = device->name;
    result.provenance["driver"] = device->driver;
  }
  sender_.send(CellMeasured{cell, result});
}

std::vector<std::unique_ptr<PipelineWork>> Worker::pipelines() const {
  std::map<std::size_t, std::unique_ptr<PipelineWork>> works;
  for (const std::size_t c : cells_) {
    const Cell& cell = plan_.cells[c];
    if (cell.workload && !rays_.contains(*cell.workload)) continue;  // has failed
    auto& work = works[cell.pipeline];
    if (!work) work = std::make_unique<PipelineWork>();
    work->index = cell.pipeline;
    if (cell.workload) {
      work->trace_cells.push_back(c);
    } else {
      work->build_cell = c;
    }
  }
  std::vector<std::unique_ptr<PipelineWork>> list;
  list.reserve(works.size());
  for (auto& [index, work] : works) list.push_back(std::move(work));
  return list;
}

BuildContext Worker::context_of(const PipelineWork& work) const {
  BuildContext context = context_;
  context.threads = plan_.pipelines[work.index].threads;
  return context;
}

/// The build whose tree is measured and traced; the timed ones come later.
void Worker::build(PipelineWork& work) {
  work.pipeline = std::make_unique<Pipeline>(plan_.pipelines[work.index]);
  const BuildContext context = context_of(work);
  const ThreadLimit limit(context.threads);
  const PeakMemory peak;
  work.accel = work.pipeline->run(*scene_, context, work.first_times,
                                  [&](std::string_view stage) { announce(Scope::pipeline, work.index, stage); });
  if (const std::optional<double> bytes = peak.bytes()) {
    work.build_result.values["peak_memory"] = {ValueClass::absolute, "bytes", {*bytes}};
  }
  work.build_result.values["triangles"] = exact("1", static_cast<double>(scene_->triangles.size()));
}

void Worker::measure_tree(PipelineWork& work, const Accel& accel, const Scene& scene) {
  const Registry& registry = Registry::instance();
  for (const MethodRef& ref : plan_.metrics) {
    const std::string& kind = registry.get(Role::metric, ref.name).info.accel;
    if (!kind.empty() && kind != accel.kind()) continue;
    for (MetricValue& value : registry.create<Metric>(ref)->measure(accel, scene, context_)) {
      if (!std::all_of(value.values.begin(), value.values.end(), [](double v) { return std::isfinite(v); })) {
        throw Error(fmt::format("metric '{}' gave a '{}' that is not finite", ref.name, value.name));
      }
      if (value.x.empty()) {
        if (value.values.size() != 1) {
          throw Error(fmt::format("metric '{}' gave {} numbers as '{}' and no axis", ref.name, value.values.size(), value.name));
        }
        work.build_result.values[value.name] = exact(value.unit, value.values.front());
        continue;
      }
      Series series{value.x, "1", value.unit, {}, std::move(value.values)};
      for (std::size_t i = 0; i < series.y.size(); ++i) series.x.push_back(static_cast<double>(i));
      work.build_result.series[value.name] = std::move(series);
    }
  }
}

void Worker::check_trace(PipelineWork& work, std::size_t cell) {
  auto trace = std::make_unique<TraceWork>();
  trace->cell = cell;
  const Rays& rays = rays_.at(*plan_.cells[cell].workload);
  trace->rays = &rays;
  const std::size_t count = rays.batch.rays.size();
  const bool right = guarded(Spent::checks, Scope::cell, cell, "tracing", [&] {
    trace->tracer = Registry::instance().create<Tracer>(plan_.tracers[*plan_.cells[cell].tracer].tracer);
    const int threads = plan_.pipelines[work.index].threads;
    const ThreadLimit limit(threads);
    trace->session = trace->tracer->prepare(*work.accel, *scene_, threads, rays.batch.coherent);
    std::vector<Hit> hits(count);
    trace->session->trace(rays.batch.rays, hits, rays.batch.query);
    announce(Scope::cell, cell, "checking hits");
    const bool watertight = trace->session->watertight();
    const OracleReport report = oracle_->check(rays.batch.rays, hits, rays.reference, rays.batch.query, watertight);
    require_right(report, rays.batch);
    if (!watertight) trace->result.values["leaks"] = exact("1", static_cast<double>(report.leaks));
    const auto met = std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); });
    trace->result.values["ray_count"] = exact("1", static_cast<double>(count));
    trace->result.values["hit_share"] = exact("1", static_cast<double>(met) / static_cast<double>(count));
    if (!trace->session->counts()) return;
    announce(Scope::cell, cell, "counting steps");
    add_counts(trace->result, trace->session->count(rays.batch.rays, rays.batch.query, {}), static_cast<double>(count));
  });
  if (right) work.traces.push_back(std::move(trace));
}

void Worker::run() {
  vulkan::choose_device(plan_.device);
  const std::size_t scene = plan_.cells[cells_.front()].scene;
  if (!guarded(Spent::set_up, Scope::scene, scene, "opening the scene", [this] { open_the_scene(); })) return;
  sender_.send(SceneOpened{scene_->hash});
  // Loading and checking may use the whole machine, the methods only what the experiment gives them.
  int most_threads = plan_.threads;
  for (const PipelineSpec& pipeline : plan_.pipelines) most_threads = std::max(most_threads, pipeline.threads);
  const ThreadLimit limit(most_threads);
  if (plan_.animation) {
    AnimationRun(*this, plan_.animation->frames).run();
  } else {
    make_rays(*scene_, workloads());
    run_group_by_group();
  }
}

void Worker::run_group_by_group() {
  const std::size_t scene = plan_.cells[cells_.front()].scene;
  // Structures that are traced stay in memory until all of their group are timed. A group takes at most half the free memory.
  const double budget = available_memory() / 2;
  double held = 0;
  std::vector<std::unique_ptr<PipelineWork>> group;
  for (auto& work : pipelines()) {
    if (!guarded(Spent::warm_up, Scope::pipeline, work->index, "building", [&] { build(*work); })) continue;
    const auto check = [&] { require_valid(*work->accel, *scene_); };
    if (!guarded(Spent::checks, Scope::pipeline, work->index, "checking the tree", check)) continue;
    if (work->build_cell && !guarded(Spent::checks, Scope::cell, *work->build_cell, "measuring the tree",
                                     [&] { measure_tree(*work, *work->accel, *scene_); })) {
      work->build_cell.reset();
    }
    for (const std::size_t cell : work->trace_cells) check_trace(*work, cell);
    if (work->traces.empty()) work->accel.reset();
    held += work->accel ? static_cast<double>(work->accel->bytes()) : 0;
    group.push_back(std::move(work));
    if (held > budget) {
      sender_.send(Note{
          fmt::format("{}: the structures of {} methods fill half the free memory; they are timed now, apart from the others",
                      plan_.scenes[scene].label, group.size())});
      time_group(group);
      held = 0;
    }
  }
  time_group(group);
}

void run_worker(const Plan& plan, std::vector<std::size_t> cells, const WorkerOptions& options, Board& board,
                const MessageSender& sender) {
  // An exception out of a noexcept function or a bare thread ends the process; its cause would be lost with it.
  static std::function<void()> tell;
  tell = [&plan, &board] {
    const std::string stage = board.stage().text;
    try {
      if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
      board.last_words(out_of_memory(plan, stage));
    } catch (const std::exception& error) {
      board.last_words(fmt::format("crashed: uncaught exception while {}: {}", stage, error.what()));
    } catch (...) {
    }
  };
  std::set_terminate([] {
    tell();
    std::abort();
  });
  Worker(plan, std::move(cells), options, board, sender).run();
}

}  // namespace raystudy
