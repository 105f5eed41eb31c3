#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

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
template <class M, class Tree>
void measure_all(Tree& tree, const M& measure) {
  for (auto& pair : tree.pairs) {
    const auto m = measure_both(measure, pair.boxes);
    pair.measure = {m[0], m[1]};
  }
}

/// Calls f(link, measure) for every node, in the order of the records.
template <class Tree, class F>
void for_each_pair_slot(const Tree& tree, F&& f) {
  f(tree.pairs[0].link[0], tree.pairs[0].measure[0]);
  for (std::size_t p = 1; p < tree.pairs.size(); ++p) {
    f(tree.pairs[p].link[0], tree.pairs[p].measure[0]);
    f(tree.pairs[p].link[1], tree.pairs[p].measure[1]);
  }
}

/// Σ_inner m(N) over a measured tree, in double in the order of the records.
template <class Tree>
[[nodiscard]] double inner_measure_sum(const Tree& tree) {
  double sum = 0;
  for_each_pair_slot(tree, [&](std::uint32_t link, float m) { sum += Tree::is_leaf(link) ? 0.0 : static_cast<double>(m); });
  return sum;
}

/// Σ_leaf m(N) · t_N over a measured tree, in double in the order of the records.
template <class Tree>
[[nodiscard]] double leaf_measure_sum(const Tree& tree) {
  double sum = 0;
  for_each_pair_slot(tree, [&](std::uint32_t link, float m) {
    if (Tree::is_leaf(link)) sum += static_cast<double>(m) * tree.leaves[link & ~Tree::leaf_bit].count;
  });
  return sum;
}

}  // namespace raystudy
