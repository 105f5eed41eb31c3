#pragma once

#include <cstddef>
#include <cstring>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"

namespace raystudy::test {

/// nodes[1] is padding, whatever it holds.
inline bool same(const Bvh2& a, const Bvh2& b) {
  if (a.nodes.size() != b.nodes.size() || a.triangles != b.triangles || a.duplicates != b.duplicates) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (i != 1 && std::memcmp(&a.nodes[i], &b.nodes[i], sizeof(Bvh2Node)) != 0) return false;
  }
  return true;
}

inline bool same(const WideBvh& a, const WideBvh& b) {
  return a.nodes == b.nodes && a.triangles == b.triangles && a.corners == b.corners && a.bounds == b.bounds &&
         a.height == b.height && a.duplicates == b.duplicates;
}

}  // namespace raystudy::test
