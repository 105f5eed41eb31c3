#pragma once

#include <exception>
#include <functional>
#include <string>
#include <vector>

namespace raystudy {

/// That this process has had on all its threads.
[[nodiscard]] double process_cpu_seconds();

/// One execution of a piece of work: its seconds as the work measured them itself, in all and by part.
struct Lap {
  double seconds = 0;
  std::vector<double> parts;  ///< the same number of parts at every lap
};

/// One repetition: the mean over its iterations.
struct TimedSample {
  double seconds = 0;
  double cpu_seconds = 0;  ///< of all threads of the process
  double iterations = 0;
  std::vector<double> parts;
};

/// A piece of work to be timed.
struct TimedWork {
  std::string name;  ///< unique in one call of time_interleaved
  std::function<Lap()> run_once;
  std::function<void(std::vector<TimedSample>)> finished;  ///< after the last repetition, samples in the order measured
  std::function<void(std::exception_ptr)> failed;          ///< where run_once threw; the work is not run again
};

struct TimingOptions {
  int repetitions = 3;
  double warm_up_seconds = 0;
  double sample_seconds = 0.02;           ///< work shorter than this is iterated within a repetition until it takes so long
  std::function<void()> on_repetition{};  ///< called before each repetition; may be empty
};

/// Times all works with Google Benchmark, the repetitions of all of them in one random order, so that a disturbance or a drift of
/// the machine's speed meets all alike. Must be called on a thread of its own process's choice but never twice at once.
void time_interleaved(std::vector<TimedWork> works, const TimingOptions& options);

}  // namespace raystudy
