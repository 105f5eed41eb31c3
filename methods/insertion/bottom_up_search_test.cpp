#include "methods/insertion/bottom_up_search.h"

#include <gtest/gtest.h>

#include <limits>

#include "methods/insertion/reinsertion.h"
#include "tests/support/trees.h"

namespace raystudy::insertion {
namespace {

const SurfaceArea area;

using test::bar;
using test::inner;
using test::leaf;

/// root (P, Q), P (A = [0, 1], D = [12, 13]), Q (C = [10, 11], B = [2, 3]): records 1, 2 and 3.
Bvh2 crossed_bars() {
  Bvh2 bvh;
  bvh.nodes = {inner(bar(0, 13), 2), {},
               inner(bar(0, 13), 4), inner(bar(2, 11), 6),
               leaf(bar(0, 1), 0),   leaf(bar(12, 13), 1),
               leaf(bar(10, 11), 2), leaf(bar(2, 3), 3)};
  bvh.triangles = {0, 1, 2, 3};
  return bvh;
}
constexpr std::uint32_t a_slot = 4;
constexpr std::uint32_t d_slot = 5;
constexpr std::uint32_t c_slot = 6;
constexpr std::uint32_t b_slot = 7;

TEST(BottomUpSearch, GainOfANodeByHand) {
  PairTree tree(crossed_bars());
  measure_all(tree, area);
  BottomUpSearch<SurfaceArea> search(tree, area);
  // Without D, P of 27 goes. Beside C, D makes a parent [10, 13] of 7, and Q grows from [2, 11] = 19 to [2, 13] = 23.
  const auto d = search.of_node(d_slot);
  EXPECT_EQ(d.slot, c_slot);
  EXPECT_FLOAT_EQ(d.gain, 27 - 7 - (23 - 19));
  // A beside B: a parent [0, 3] of 7, and Q grows to [0, 11] = 23.
  const auto a = search.of_node(a_slot);
  EXPECT_EQ(a.slot, b_slot);
  EXPECT_FLOAT_EQ(a.gain, 27 - 7 - (23 - 19));
  // B beside A: Q of 19 goes, a parent [0, 3] of 7 comes, P is as large as it can be.
  const auto b = search.of_node(b_slot);
  EXPECT_EQ(b.slot, a_slot);
  EXPECT_FLOAT_EQ(b.gain, 19 - 7);
}

TEST(BottomUpSearch, StaysWhereThereIsNothingToGain) {
  Bvh2 bvh;  // root (X, C), X (A, B)
  bvh.nodes = {inner(bar(0, 9), 2), {}, inner(bar(0, 3), 4), leaf(bar(8, 9), 0), leaf(bar(0, 1), 1), leaf(bar(2, 3), 2)};
  bvh.triangles = {0, 1, 2};
  PairTree tree(bvh);
  measure_all(tree, area);
  BottomUpSearch<SurfaceArea> search(tree, area);
  for (std::uint32_t slot = 2; slot < 2 * tree.pairs.size(); ++slot) {
    EXPECT_EQ(search.of_node(slot).gain, 0) << slot;
    EXPECT_EQ(search.of_node(slot).slot, 0U) << slot;
  }
}

TEST(BottomUpSearch, AncestorsThatShrinkCount) {
  Bvh2 bvh;  // root (R, E), R (S, C), S (A, B) with B = [8, 9] far out: as R's sibling it makes S and R small
  bvh.nodes = {inner(bar(0, 9), 2), {},
               inner(bar(0, 9), 4), leaf(bar(7, 9), 0),
               inner(bar(0, 9), 6), leaf(bar(2, 3), 1),
               leaf(bar(0, 1), 2),  leaf(bar(8, 9), 3)};
  bvh.triangles = {0, 1, 2, 3};
  PairTree tree(bvh);
  measure_all(tree, area);
  BottomUpSearch<SurfaceArea> search(tree, area);
  const auto b = search.of_node(7);
  EXPECT_EQ(b.slot, 3U);                       // beside E
  EXPECT_FLOAT_EQ(b.gain, 19 + (19 - 7) - 5);  // S goes, R becomes [0, 3], the new parent is [7, 9]
}

TEST(BottomUpSearch, ChildrenByHand) {
  PairTree tree(crossed_bars());
  measure_all(tree, area);
  BottomUpSearch<SurfaceArea> search(tree, area);
  // Without A and D, P and the root of 27 each go and Q is the root. D goes beside C (7, and Q grows by 4), A beside B (the
  // same).
  const auto places = search.of_children(2);
  EXPECT_EQ(places.slot, (std::array<std::uint32_t, 2>{b_slot, c_slot}));
  EXPECT_FLOAT_EQ(places.freed, 27 + 27);
  EXPECT_FLOAT_EQ(places.cost, 11 + 11);
}

/// What the sum of inner measures falls by when the node at `slot` is moved beside the one at `to`.
double gain_of(const PairTree& tree, std::uint32_t slot, std::uint32_t to) {
  PairTree copy = tree;
  TreeEdit<SurfaceArea> edit(copy, area);
  const double before = edit.inner_sum();
  const auto removed = edit.remove_child(slot / 2, slot % 2);
  edit.insert(removed.node, to, removed.free);
  return before - edit.inner_sum();
}

bool is_within(const PairTree& tree, std::uint32_t slot, std::uint32_t top) {
  while (slot != top && slot >= 2) slot = tree.up[slot / 2];
  return slot == top;
}

TEST(BottomUpSearch, FindsTheBestOfAllPlacesOfANode) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(5 * seed, seed));
    PairTree tree(test::random_tree(scene, seed));
    measure_all(tree, area);
    BottomUpSearch<SurfaceArea> search(tree, area);
    for (std::uint32_t slot = 2; slot < 2 * tree.pairs.size(); ++slot) {
      double best = 0;
      for (std::uint32_t to = 0; to < 2 * tree.pairs.size(); ++to) {
        if (to == 1 || to == (slot ^ 1U) || is_within(tree, to, slot)) continue;
        best = std::max(best, gain_of(tree, slot, to));
      }
      const auto found = search.of_node(slot);
      ASSERT_NEAR(static_cast<double>(found.gain), best, 3e-5) << "seed " << seed << ", slot " << slot;
      if (found.gain > 0) {
        ASSERT_NEAR(static_cast<double>(found.gain), gain_of(tree, slot, found.slot), 1e-5);
      }
    }
  }
}

TEST(BottomUpSearch, FindsTheBestOfAllPlacesOfChildren) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(5 * seed, seed));
    const PairTree tree = [&] {
      PairTree measured(test::random_tree(scene, seed));
      measure_all(measured, area);
      return measured;
    }();
    BottomUpSearch<SurfaceArea> search(tree, area);
    for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) {
      if (n == tree.root()) continue;
      PairTree rest = tree;
      Reinsertion<SurfaceArea> edit(rest, area);
      const double before = edit.inner_sum();
      const auto removed = edit.remove(n);
      const auto found = search.of_children(n);
      ASSERT_NEAR(static_cast<double>(found.freed), before - edit.inner_sum(), 1e-5);
      float least_of_both = 0;
      for (const PairTree::Node& child : removed.nodes) least_of_both += edit.search(child, removed.old_slot).cost;
      ASSERT_NEAR(found.cost, least_of_both, 1e-5F) << "seed " << seed << ", node " << n;
      float cost_there = 0;
      for (std::uint32_t side = 0; side < 2; ++side) cost_there += edit.merge_cost(tree.node(2 * n + side), found.slot[side]);
      ASSERT_NEAR(found.cost, cost_there, 1e-5F);
    }
  }
}

}  // namespace
}  // namespace raystudy::insertion
