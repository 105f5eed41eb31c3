#pragma once

#include <cstdint>

#include "harness/method/method.h"

namespace raystudy {

// Counters are template arguments of a traversal, so that its timed pass has none of this.

struct NoCounter {
  void inner() {}
  void leaf() {}
  void boxes(std::uint32_t) {}
  void triangles(std::uint32_t) {}
};

struct RayCounter {
  TraceCounts counts;
  void inner() { ++counts.inner_nodes; }
  void leaf() { ++counts.leaves; }
  void boxes(std::uint32_t n) { counts.box_tests += n; }
  void triangles(std::uint32_t n) { counts.triangle_tests += n; }
};

}  // namespace raystudy
