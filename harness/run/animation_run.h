#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "harness/run/worker_steps.h"

namespace raystudy {

/// What a worker does where the experiment plays animations: prepares every method's updater, then plays the animation once for
/// exact numbers and checks and once a repetition for times. Within a frame the methods take turns in random order, so that a
/// disturbance meets all alike; the preparations are timed at the end as builds are.
class AnimationRun {
 public:
  AnimationRun(Worker& worker, std::size_t frames);
  void run();

 private:
  using Passes = std::vector<std::vector<double>>;  ///< [repetition][frame], seconds

  struct Traced {
    std::size_t cell = 0;
    std::unique_ptr<Tracer> tracer;
    CellResult result;
    Passes seconds;
    Passes cpu_seconds;
    std::vector<double> rays;  ///< [frame]
    double hits = 0;
    std::optional<double> leaks;
    std::optional<TraceCounts> counts;
    bool failed = false;
  };
  struct Played {
    std::unique_ptr<PipelineWork> work;
    std::unique_ptr<UpdateSession> session;
    Passes seconds;
    std::vector<double> costs;
    std::vector<double> rebuilt;
    std::vector<Traced> traces;
    bool failed = false;
  };
  /// The scene and the rays of one frame.
  struct FrameRays {
    Scene scene;
    std::map<std::size_t, Rays> rays;  ///< by workload
  };

  std::unique_ptr<UpdateSession> prepare(const Played& played, StageTimes& times, std::vector<CostSample>* trace);
  void prepare_all();
  std::shared_ptr<FrameRays> frame_rays(std::size_t frame);
  void play(std::optional<std::size_t> repetition);
  void play_frame(Played& played, FrameRays& rays, std::size_t frame, std::optional<std::size_t> repetition);
  void check_frame(Played& played, const Accel& tree, const Accel& accel, const FrameRays& rays, std::size_t frame);
  void check_trace(Traced& trace, const Accel& accel, const FrameRays& rays, int threads);
  void time_trace(Traced& trace, const Accel& accel, const FrameRays& rays, int threads, std::size_t repetition);
  void add_frame_values(Played& played) const;
  void send_traces(Played& played);
  void time_preparations();

  Worker& worker_;
  std::vector<double> times_;
  std::vector<std::unique_ptr<Played>> methods_;
  std::set<std::size_t> workloads_;
  std::vector<std::shared_ptr<FrameRays>> kept_;  ///< by frame; null where there was no room
  double kept_bytes_ = 0;
};

}  // namespace raystudy
