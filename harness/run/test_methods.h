#pragma once

#include <string>
#include <vector>

#include "harness/scene/scene.h"
#include "harness/spec/plan.h"

namespace raystudy {

inline constexpr int test_triangles = 64;

/// A strip of `test_triangles` triangles; "missing" and "broken" as catalog scenes can be.
[[nodiscard]] Scene open_test_scene(const SceneSpec& spec);

/// A pipeline whose builder does what `behaviour` says (test_methods.cpp). "good optimized" adds two optimizers.
[[nodiscard]] PipelineSpec test_pipeline(const std::string& behaviour);

/// One scene, one build cell a behaviour.
[[nodiscard]] Plan test_plan(const std::vector<std::string>& behaviours);

/// Adds a workload of rays straight down on the strip, and one cell of the plan's first pipeline for each tracer's behaviour.
void add_traces(Plan& plan, const std::vector<std::string>& behaviours, bool workload_fails = false);

/// Plays the strip, which rises, in `frames` frames; the plan's pipelines get an updater of this behaviour (test_methods.cpp).
void add_animation(Plan& plan, std::size_t frames, const std::string& behaviour);

/// Adds a metric that gives `answer` = 42 and the series `by_depth`; "not finite" spoils it.
void add_metric(Plan& plan, const std::string& behaviour);

}  // namespace raystudy
