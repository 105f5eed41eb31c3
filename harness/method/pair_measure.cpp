#include "harness/method/pair_measure.h"

#include <cstddef>

namespace raystudy {
namespace {

template <class F>
void for_each_slot(const PairTree& tree, F&& f) {
  f(tree.pairs[0].link[0], tree.pairs[0].measure[0]);
  for (std::size_t p = 1; p < tree.pairs.size(); ++p) {
    f(tree.pairs[p].link[0], tree.pairs[p].measure[0]);
    f(tree.pairs[p].link[1], tree.pairs[p].measure[1]);
  }
}

}  // namespace

double inner_measure_sum(const PairTree& tree) {
  double sum = 0;
  for_each_slot(tree, [&](std::uint32_t link, float m) { sum += PairTree::is_leaf(link) ? 0.0 : static_cast<double>(m); });
  return sum;
}

double leaf_measure_sum(const PairTree& tree) {
  double sum = 0;
  for_each_slot(tree, [&](std::uint32_t link, float m) {
    if (PairTree::is_leaf(link)) sum += static_cast<double>(m) * tree.leaves[link & ~PairTree::leaf_bit].count;
  });
  return sum;
}

}  // namespace raystudy
