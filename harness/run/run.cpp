#include "harness/run/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/progress.h"
#include "harness/run/child.h"
#include "harness/run/google_benchmark.h"
#include "harness/run/memory.h"
#include "harness/run/provenance.h"
#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/spec/cell_id.h"
#include "harness/spec/cells.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// One call of run_plan.
class Run {
 public:
  Run(const Plan& plan, const RunOptions& options)
      : plan_(plan),
        options_(options),
        folder_(results_folder(plan, options.results)),
        progress_(plan.name, static_cast<double>(plan.cells.size()), 0, options.log) {
    require_writable_folder(folder_);
    remove_stale_temporaries(folder_);
    provenance_ = run_provenance(plan, options.command);
    open_ = options.open;
    if (!open_) open_catalog();
  }

  RunSummary run();

 private:
  using Pending = std::vector<std::size_t>;  ///< indices into Plan::cells

  [[nodiscard]] bool is_reusable(std::size_t cell);
  void open_catalog();
  void run_scene(std::size_t scene, Pending& pending);
  void follow(Child& child, Board& board, Pending& pending);
  void handle(const Message& message, const Board& board, Pending& pending);
  void record(std::size_t cell, CellResult result, Pending& pending);
  void fail_scope(Scope scope, std::size_t index, CellStatus status, const std::string& reason, Pending& pending);
  void show(const Board& board, const Pending& pending);
  [[nodiscard]] double seconds_left(const Board::Stage& stage) const;
  [[nodiscard]] std::string timed_out(const Board::Stage& stage) const {
    return fmt::format("timed out after {:g} s while {}", plan_.timeout_seconds, stage.text);
  }
  [[nodiscard]] bool in_scope(std::size_t cell, Scope scope, std::size_t index) const;

  const Plan& plan_;
  const RunOptions& options_;
  double start_ = Board::now_seconds();
  fs::path folder_;
  Progress progress_;
  std::map<std::string, std::string> provenance_;
  std::string scene_hash_;
  OpenScene open_;
  std::function<std::optional<std::string>(const SceneSpec&)> why_not_installed_;
  RunSummary summary_;
  std::size_t processes_ = 0;
  std::size_t settled_ = 0;  ///< cells of this run that have a result
};

bool Run::is_reusable(std::size_t cell) {
  const std::string id = cell_id(plan_, plan_.cells[cell]);
  const fs::path file = result_file(folder_, id);
  if (options_.force || !fs::exists(file)) return false;
  try {
    const CellResult result = read_result(file);
    if (result.id == id) return result.status == CellStatus::done;
    progress_.line(fmt::format("{}: holds the result '{}'; measured again", file.string(), result.id));
  } catch (const Error& error) {
    progress_.line(fmt::format("{}; measured again", error.what()));
  }
  return false;
}

bool Run::in_scope(std::size_t c, Scope scope, std::size_t index) const {
  const Cell& cell = plan_.cells[c];
  switch (scope) {
    case Scope::scene: return cell.scene == index;
    case Scope::workload: return cell.workload == index;
    case Scope::pipeline: return cell.pipeline == index;
    case Scope::cell: return c == index;
  }
  return false;
}

void Run::record(std::size_t c, CellResult result, Pending& pending) {
  const Cell& cell = plan_.cells[c];
  result.id = cell_id(plan_, cell);
  result.experiment = plan_.name;
  result.scene = plan_.scenes[cell.scene].label;
  result.method = plan_.pipelines[cell.pipeline].label;
  if (cell.tracer) result.tracer = plan_.tracers[*cell.tracer].label;
  if (cell.workload) result.workload = plan_.workloads[*cell.workload].label;
  result.provenance.insert(provenance_.begin(), provenance_.end());
  result.provenance["threads"] = fmt::format("{}", plan_.pipelines[cell.pipeline].threads);
  result.provenance["scene_hash"] = scene_hash_;
  result.provenance["date"] = utc_now();
  write_result(folder_, result);
  std::erase(pending, c);
  ++settled_;
  const std::string path = cell_path(plan_, cell);
  switch (result.status) {
    case CellStatus::done: ++summary_.done; break;
    case CellStatus::failed: ++summary_.failed; break;
    case CellStatus::missing: ++summary_.missing; break;
  }
  const std::string outcome = result.status == CellStatus::done ? "done" : result.reason;
  progress_.line(fmt::format("[{:>{}}/{}] {}: {}", settled_, fmt::formatted_size("{}", plan_.cells.size()), plan_.cells.size(),
                             path, outcome));
}

void Run::fail_scope(Scope scope, std::size_t index, CellStatus status, const std::string& reason, Pending& pending) {
  const Pending all = pending;
  for (const std::size_t c : all) {
    if (!in_scope(c, scope, index)) continue;
    CellResult result;
    result.status = status;
    result.reason = reason;
    record(c, std::move(result), pending);
  }
}

void Run::handle(const Message& message, const Board& board, Pending& pending) {
  if (const auto* opened = std::get_if<SceneOpened>(&message)) {
    scene_hash_ = opened->hash;
  } else if (const auto* measured = std::get_if<CellMeasured>(&message)) {
    const Board::Stage stage = board.stage();
    if (stage.scope == Scope::cell && stage.index == measured->cell && seconds_left(stage) <= 0) {
      // Late, but done before it was looked for.
      fail_scope(Scope::cell, measured->cell, CellStatus::failed, timed_out(stage), pending);
    } else {
      record(measured->cell, measured->result, pending);
    }
  } else if (const auto* failed = std::get_if<ScopeFailed>(&message)) {
    fail_scope(failed->scope, failed->index, failed->status, failed->reason, pending);
  } else {
    progress_.line(std::get<Note>(message).text);
  }
}

double Run::seconds_left(const Board::Stage& stage) const {
  if (plan_.timeout_seconds <= 0 || stage.start == 0) return std::numeric_limits<double>::infinity();
  return plan_.timeout_seconds - stage.seconds_before - (Board::now_seconds() - stage.start);
}

void Run::show(const Board& board, const Pending& pending) {
  const Board::Stage stage = board.stage();
  const auto first =
      std::find_if(pending.begin(), pending.end(), [&](std::size_t c) { return in_scope(c, stage.scope, stage.index); });
  const double repetitions = static_cast<double>(pending.size()) * plan_.repetitions;
  const double share = repetitions > 0 ? std::min(0.95, board.repetitions() / repetitions) : 0;
  const std::string what = first == pending.end()        ? std::string{}
                           : stage.scope == Scope::scene ? plan_.scenes[plan_.cells[*first].scene].label
                                                         : cell_path(plan_, plan_.cells[*first]);
  progress_.update(static_cast<double>(settled_) + share * static_cast<double>(pending.size()),
                   fmt::format("{}: {}", what, stage.text));
}

/// Deals with a worker's messages until it ends, is late, or the run is interrupted.
void Run::follow(Child& child, Board& board, Pending& pending) {
  // A stage may begin unseen while the parent waits for a message: it looks again and again. A bar is drawn as often.
  const double look_again = plan_.timeout_seconds > 0 ? std::clamp(plan_.timeout_seconds / 4, 0.01, 0.5) : 0.5;
  MessageReceiver receiver(child.socket());
  while (!InterruptWatch::interrupted()) {
    const Board::Stage stage = board.stage();
    if (seconds_left(stage) <= 0) {
      child.kill();
      (void)child.wait();
      fail_scope(stage.scope, stage.index, CellStatus::failed, timed_out(stage), pending);
      return;
    }
    if (!InterruptWatch::wait_readable(child.socket(), std::min(look_again, seconds_left(stage)))) {
      show(board, pending);
      continue;
    }
    if (!receiver.read()) break;
    while (const std::optional<Message> message = receiver.next()) {
      handle(*message, board, pending);
      receiver.acknowledge();
    }
  }
  if (InterruptWatch::interrupted()) {
    summary_.interrupted = true;
    child.kill();
    (void)child.wait();
    return;
  }
  const std::optional<std::string> crash = child.wait();
  if (!crash) return;
  const Board::Stage stage = board.stage();
  std::string reason = board.last_words();
  if (reason.empty()) {
    reason = fmt::format("crashed: {} while {}", *crash, stage.text.empty() ? "starting" : stage.text);
    // Nothing in the worker sends it to itself.
    if (*crash == "SIGKILL") reason += " (killed from outside; the system may have run out of memory)";
  }
  const std::size_t before = pending.size();
  fail_scope(stage.scope, stage.index, CellStatus::failed, reason, pending);
  // The stage's own cells may all be settled: it died between two stages. Then what is left must not be tried for ever.
  if (pending.size() == before) {
    const Pending all = pending;
    for (const std::size_t c : all) fail_scope(Scope::cell, c, CellStatus::failed, reason, pending);
  }
}

/// The catalog is read once for all scenes; workers find it in their copy of this process.
void Run::open_catalog() {
  const double start = Board::now_seconds();
  const auto catalog = std::make_shared<const Catalog>(read_catalog(catalog_path()));
  open_ = [catalog](const SceneSpec& s) { return open_scene(*catalog, s.name, s.triangles, s.seed); };
  why_not_installed_ = [catalog](const SceneSpec& s) { return why_not_installed(*catalog, s.name); };
  summary_.set_up += Board::now_seconds() - start;
}

void Run::run_scene(std::size_t scene, Pending& pending) {
  if (why_not_installed_) {
    provenance_.erase("timing_group");  // the scene before's
    if (const std::optional<std::string> reason = why_not_installed_(plan_.scenes[scene])) {
      fail_scope(Scope::scene, scene, CellStatus::missing, *reason, pending);
    }
  }
  while (!pending.empty() && !InterruptWatch::interrupted()) {
    // Times may be divided by each other where one process took them in turn.
    provenance_["timing_group"] = fmt::format("{}, process {}", utc_now(), ++processes_);
    SharedBoard board;
    Child child([this, &pending, &board](int socket) {
      run_worker(plan_, pending, {open_, options_.sample_seconds}, *board, MessageSender(socket));
    });
    const std::size_t before = pending.size();
    follow(child, *board, pending);
    summary_.measured += board->time(Spent::measured);
    summary_.warm_up += board->time(Spent::warm_up);
    summary_.set_up += board->time(Spent::set_up);
    summary_.checks += board->time(Spent::checks);
    if (pending.size() == before && !InterruptWatch::interrupted()) {
      throw std::logic_error("a worker ended well and left cells without a result");
    }
  }
}

RunSummary Run::run() {
  const InterruptWatch watch;
  if (plan_.memory_limit_bytes > 0 && !MemoryLimit::is_enforced()) {
    progress_.line("memory limit: not enforced, since this Raystudy is built with a sanitizer");
    provenance_["memory_limit"] = "not enforced (sanitizer)";
  }
  std::map<std::size_t, Pending> by_scene;
  for (std::size_t c = 0; c < plan_.cells.size(); ++c) {
    if (is_reusable(c)) {
      ++summary_.reused;
      ++settled_;
    } else {
      by_scene[plan_.cells[c].scene].push_back(c);
    }
  }
  for (auto& [scene, pending] : by_scene) {
    const std::size_t before = summary_.done;
    scene_hash_.clear();
    if (!InterruptWatch::interrupted()) run_scene(scene, pending);
    summary_.left += pending.size();
    if (summary_.done > before) write_google_benchmark(plan_, scene, folder_);
  }
  summary_.interrupted = InterruptWatch::interrupted();
  summary_.wall = Board::now_seconds() - start_;
  return summary_;
}

}  // namespace

std::filesystem::path results_folder(const Plan& plan, const std::filesystem::path& results) { return results / plan.name; }

std::vector<CellResult> read_results(const Plan& plan, const fs::path& results) {
  std::vector<CellResult> found;
  std::vector<Diagnostic> problems;
  for (const Cell& cell : plan.cells) {
    const fs::path file = result_file(results_folder(plan, results), cell_id(plan, cell));
    if (!fs::exists(file)) continue;
    try {
      found.push_back(read_result(file));
    } catch (const Error& error) {
      problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }
  if (!problems.empty()) throw Error(std::move(problems));
  return found;
}

std::string RunSummary::text() const {
  std::string cells = fmt::format("{} measured, {} reused, {} failed, {} missing", done, reused, failed, missing);
  if (left > 0) cells += fmt::format(", {} left", left);
  return fmt::format(
      "cells: {}\ntime: {} = {} measured + {} first builds + {} set-up + {} checks + {} harness ({:.2f} % of measured)", cells,
      duration_text(wall), duration_text(measured), duration_text(warm_up), duration_text(set_up), duration_text(checks),
      duration_text(harness()), measured > 0 ? 100 * harness() / measured : 0.0);
}

RunSummary run_plan(const Plan& plan, const RunOptions& options) { return Run(plan, options).run(); }

}  // namespace raystudy
