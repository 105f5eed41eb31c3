#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "harness/run/board.h"
#include "harness/run/message.h"
#include "harness/scene/scene.h"
#include "harness/spec/plan.h"

namespace raystudy {

using OpenScene = std::function<Scene(const SceneSpec&)>;

struct WorkerOptions {
  OpenScene open;
  double sample_seconds = 0.02;  ///< TimingOptions::sample_seconds
};

/// Measures cells of one scene; runs in a process of its own.
///
/// Opens the scene and makes the rays; builds each pipeline once for its exact numbers, its peak memory and the structure that is
/// traced; holds every tracer's hits against Embree's, and counts; then times builds and traces, their repetitions in random
/// order. Every cell gets one message: its measurements, or why there are none. An exception costs the cells it concerns, no
/// others.
void run_worker(const Plan& plan, std::vector<std::size_t> cells, const WorkerOptions& options, Board& board,
                const MessageSender& sender);

}  // namespace raystudy
