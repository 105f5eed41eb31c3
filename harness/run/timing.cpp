#include "harness/run/timing.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <ctime>
#include <map>
#include <memory>
#include <stdexcept>

namespace raystudy {

double process_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}
namespace {

struct Task {
  TimedWork work;
  bool failed = false;
};

std::string part_counter(std::size_t i) { return fmt::format("part{}", i); }
constexpr const char* cpu_counter = "cpu_seconds";

void run_repetition(Task& task, const std::function<void()>& on_repetition, benchmark::State& state) {
  if (on_repetition) on_repetition();
  if (task.failed) {
    state.SkipWithError("failed in an earlier repetition");
    return;
  }
  std::vector<double> parts;
  double cpu = 0;
  try {
    for (auto _ : state) {
      (void)_;
      const double cpu_before = process_cpu_seconds();
      const Lap lap = task.work.run_once();
      cpu += process_cpu_seconds() - cpu_before;
      state.SetIterationTime(lap.seconds);
      parts.resize(lap.parts.size());
      for (std::size_t i = 0; i < parts.size(); ++i) parts[i] += lap.parts[i];
    }
  } catch (...) {
    task.failed = true;
    state.SkipWithError("failed");
    task.work.failed(std::current_exception());
    return;
  }
  state.counters[cpu_counter] = benchmark::Counter(cpu, benchmark::Counter::kAvgIterations);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    state.counters[part_counter(i)] = benchmark::Counter(parts[i], benchmark::Counter::kAvgIterations);
  }
}

/// Takes every repetition as it was measured; prints nothing.
class SampleReporter : public benchmark::BenchmarkReporter {
 public:
  explicit SampleReporter(std::map<std::string, Task>& tasks) : tasks_(tasks) {}

  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    std::vector<TimedSample> samples;
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      TimedSample sample;
      sample.iterations = static_cast<double>(run.iterations);
      sample.seconds = run.real_accumulated_time / sample.iterations;
      sample.cpu_seconds = run.counters.at(cpu_counter).value;
      for (std::size_t i = 0; run.counters.contains(part_counter(i)); ++i) {
        sample.parts.push_back(run.counters.at(part_counter(i)).value);
      }
      samples.push_back(std::move(sample));
    }
    if (runs.empty() || samples.empty()) return;
    Task& task = tasks_.at(runs.front().run_name.function_name);
    if (!task.failed) task.work.finished(std::move(samples));
  }

 private:
  std::map<std::string, Task>& tasks_;
};

/// Google Benchmark takes its settings as flags; said here in full, they override its environment variables too.
void set_flags() {
  std::array<std::string, 6> flags{"raystudy",
                                   "--benchmark_enable_random_interleaving=true",
                                   "--benchmark_report_aggregates_only=false",
                                   "--benchmark_display_aggregates_only=false",
                                   "--benchmark_out=",
                                   "--benchmark_perf_counters="};
  std::array<char*, 6> pointers{};
  for (std::size_t i = 0; i < flags.size(); ++i) pointers.at(i) = flags.at(i).data();
  int count = static_cast<int>(pointers.size());
  benchmark::Initialize(&count, pointers.data());
  if (count != 1) throw std::logic_error("Google Benchmark does not know a flag");
}

}  // namespace

void time_interleaved(std::vector<TimedWork> works, const TimingOptions& options) {
  if (works.empty()) return;
  set_flags();
  benchmark::ClearRegisteredBenchmarks();
  std::map<std::string, Task> tasks;
  for (TimedWork& work : works) {
    std::string name = work.name;
    const auto [place, is_new] = tasks.emplace(std::move(name), Task{std::move(work)});
    if (!is_new) throw std::logic_error(fmt::format("time_interleaved: two works are named '{}'", place->first));
    Task* task = &place->second;
    auto* registered = benchmark::RegisterBenchmark(
        place->first.c_str(), [task, &options](benchmark::State& s) { run_repetition(*task, options.on_repetition, s); });
    registered->UseManualTime()->Repetitions(options.repetitions)->MinTime(options.sample_seconds);
    if (options.warm_up_seconds > 0) registered->MinWarmUpTime(options.warm_up_seconds);
  }
  SampleReporter reporter(tasks);
  benchmark::RunSpecifiedBenchmarks(&reporter, ".");
  benchmark::ClearRegisteredBenchmarks();
}

}  // namespace raystudy
