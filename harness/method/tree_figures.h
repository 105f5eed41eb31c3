#pragma once

#include <cstddef>
#include <cstdint>

#include "harness/method/cost_model.h"

namespace raystudy {

/// What there is to say of a tree in a few numbers.
struct TreeFigures {
  std::size_t inner_nodes = 0;
  std::size_t leaves = 0;
  std::size_t references = 0;  ///< to triangles, from all leaves
  std::uint32_t depth = 0;     ///< of the deepest leaf, the root at 0
  double cost = 0;             ///< tree_cost
};

/// Of a Bvh2 or a WideBvh; of another Accel std::logic_error.
[[nodiscard]] TreeFigures tree_figures(const Accel& tree, const CostModel& model);

}  // namespace raystudy
