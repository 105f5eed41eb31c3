#pragma once

#include <cstddef>
#include <filesystem>

#include "harness/spec/plan.h"

namespace raystudy {

/// Writes `<folder>/google-benchmark/<scene>.json` in Google Benchmark's own format, from all results of the scene that are
/// there, so that its compare.py and CI actions read them. One entry a repetition; builds are `method/build`, traces
/// `method/tracer/workload`.
void write_google_benchmark(const Plan& plan, std::size_t scene, const std::filesystem::path& folder);

}  // namespace raystudy
