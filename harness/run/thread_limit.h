#pragma once

#include <tbb/global_control.h>

#include <algorithm>
#include <cstddef>

namespace raystudy {

/// Work in parallel takes at most `threads` threads as long as this lives, and at most what the limits around it allow.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads)
      : control_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(std::max(1, threads))) {}

 private:
  tbb::global_control control_;
};

}  // namespace raystudy
