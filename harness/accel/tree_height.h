#pragma once

#include <cstddef>

#include "harness/accel/bvh2.h"

namespace raystudy {

/// Levels below the root: 0 for a tree of one leaf or of none. Without recursion, as trees may be as deep as they have leaves.
[[nodiscard]] std::size_t tree_height(const Bvh2& bvh);

}  // namespace raystudy
