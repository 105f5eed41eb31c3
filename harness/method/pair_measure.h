#pragma once

#include <array>

#include "harness/accel/pair_tree.h"
#include "harness/method/cost_model.h"

namespace raystudy {

/// (m(first box), m(second box), the same again), rounded exactly as Box::half_area.
inline Float4 measure_both(const SurfaceArea& /*measure*/, const BoxPair& b) {
  const Float4 x = b.x + __builtin_shufflevector(b.x, b.x, 2, 3, 0, 1);
  const Float4 y = b.y + __builtin_shufflevector(b.y, b.y, 2, 3, 0, 1);
  const Float4 z = b.z + __builtin_shufflevector(b.z, b.z, 2, 3, 0, 1);
  return x * y + y * z + z * x;
}

inline Float4 measure_both(const AnyMeasure& measure, const BoxPair& b) {
  const std::array<Box, 2> boxes{b.box(0), b.box(1)};
  std::array<float, 2> m{};
  measure.evaluate(boxes, m);
  return Float4{m[0], m[1], m[0], m[1]};
}

/// Measures every node of `tree`.
template <class M>
void measure_all(PairTree& tree, const M& measure) {
  for (PairTree::Pair& pair : tree.pairs) {
    const Float4 m = measure_both(measure, pair.boxes);
    pair.measure = {m[0], m[1]};
  }
}

/// Σ_inner m(N) over a measured tree, in double in the order of the records.
[[nodiscard]] double inner_measure_sum(const PairTree& tree);
/// Σ_leaf m(N) · t_N over a measured tree, in double in the order of the records.
[[nodiscard]] double leaf_measure_sum(const PairTree& tree);

}  // namespace raystudy
