#include "methods/insertion/reinsertion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "harness/accel/validate.h"
#include "tests/support/trees.h"

namespace raystudy::insertion {
namespace {

const SurfaceArea area;

using test::bar;
using test::inner;
using test::leaf;

/// Nodes over the bars A = [0, 1] and B = [2, 3]; and over C = [10, 11] and D = [12, 13]. P = (A, B), Q = (C, D), root = (P, Q).
/// In the PairTree the root's record is 1, P's is 2 and Q's is 3.
Bvh2 four_bars() {
  Bvh2 bvh;
  bvh.nodes = {inner(bar(0, 13), 2), {},
               inner(bar(0, 3), 4),  inner(bar(10, 13), 6),
               leaf(bar(0, 1), 0),   leaf(bar(2, 3), 1),
               leaf(bar(10, 11), 2), leaf(bar(12, 13), 3)};
  bvh.triangles = {0, 1, 2, 3};
  return bvh;
}
constexpr std::uint32_t root = 0;
constexpr std::uint32_t p_slot = 2;
constexpr std::uint32_t q_slot = 3;
constexpr std::uint32_t a_slot = 4;
constexpr std::uint32_t b_slot = 5;
constexpr std::uint32_t c_slot = 6;
constexpr std::uint32_t d_slot = 7;

PairTree::Node node_of(const Box& box) { return {BoxPair::twice(box), PairTree::leaf_bit | 4, box.half_area()}; }

Box box_at(const PairTree& tree, std::uint32_t slot) { return tree.pairs[slot / 2].boxes.box(slot % 2); }

TEST(Reinsertion, MergeCostIsDirectPlusInduced) {
  PairTree tree(four_bars());
  const Reinsertion<SurfaceArea> r(tree, area);
  const auto l = node_of(bar(3, 4));
  EXPECT_FLOAT_EQ(r.merge_cost(l, root), 27);         // SA([0, 13]), nothing above
  EXPECT_FLOAT_EQ(r.merge_cost(l, p_slot), 9);        // SA([0, 4]); the root does not grow
  EXPECT_FLOAT_EQ(r.merge_cost(l, a_slot), 9 + 2);    // SA([0, 4]); P grows from 7 to 9
  EXPECT_FLOAT_EQ(r.merge_cost(l, b_slot), 5 + 2);    // SA([2, 4])
  EXPECT_FLOAT_EQ(r.merge_cost(l, q_slot), 21);       // SA([3, 13])
  EXPECT_FLOAT_EQ(r.merge_cost(l, c_slot), 17 + 14);  // SA([3, 11]); Q grows from 7 to 21
  EXPECT_FLOAT_EQ(r.merge_cost(l, d_slot), 21 + 14);
}

TEST(Reinsertion, SearchFindsTheLeastMergeCost) {
  PairTree tree(four_bars());
  Reinsertion<SurfaceArea> r(tree, area);
  for (const std::uint32_t hint : {root, p_slot, q_slot, a_slot, b_slot, c_slot, d_slot}) {
    const auto found = r.search(node_of(bar(3, 4)), hint);
    EXPECT_EQ(found.slot, b_slot);
    EXPECT_FLOAT_EQ(found.cost, 7);
  }
  // Far outside, merging with the whole tree is best: SA([0, 101]) = 203, while every place below enlarges the root as well.
  const auto far = r.search(node_of(bar(100, 101)), a_slot);
  EXPECT_EQ(far.slot, root);
  EXPECT_FLOAT_EQ(far.cost, 203);
}

TEST(Reinsertion, RemoveTakesOutTheNodeAndItsParent) {
  Bvh2 bvh = four_bars();
  bvh.nodes[5] = leaf(bar(1.5F, 3), 1);  // B is larger than A
  PairTree tree(bvh);
  Reinsertion<SurfaceArea> r(tree, area);
  EXPECT_DOUBLE_EQ(r.inner_sum(), 27 + 7 + 7);
  const auto removed = r.remove(2);  // P, whose parent is the root
  EXPECT_EQ(removed.nodes[0].box.box(0), bar(1.5F, 3));
  EXPECT_EQ(removed.nodes[1].box.box(0), bar(0, 1));
  EXPECT_EQ(removed.free, (std::array<std::uint32_t, 2>{2, 1}));
  EXPECT_EQ(removed.old_slot, root);
  EXPECT_EQ(tree.root(), 3U);  // the sibling Q is the root now
  EXPECT_EQ(tree.up[3], root);
  EXPECT_EQ(box_at(tree, root), bar(10, 13));
  EXPECT_DOUBLE_EQ(r.inner_sum(), 7);
}

TEST(Reinsertion, RemoveShrinksTheAncestors) {
  Bvh2 bvh;  // root (A, X), X (B, Y), Y (C, D), with D = [8, 9] far out
  bvh.nodes = {inner(bar(0, 9), 2), {},
               leaf(bar(0, 1), 0),  inner(bar(2, 9), 4),
               leaf(bar(2, 3), 1),  inner(bar(3, 9), 6),
               leaf(bar(3, 4), 2),  leaf(bar(8, 9), 3)};
  bvh.triangles = {0, 1, 2, 3};
  PairTree tree(bvh);
  Reinsertion<SurfaceArea> r(tree, area);
  const auto removed = r.remove(3);  // Y and its parent X: B stands beside A
  EXPECT_EQ(removed.old_slot, 3U);
  EXPECT_EQ(box_at(tree, 3), bar(2, 3));
  EXPECT_EQ(box_at(tree, root), bar(0, 3));
  EXPECT_DOUBLE_EQ(r.inner_sum(), 7);
  // C goes to B: SA([2, 4]) = 5, and the root grows from 7 to 9; beside the root it would cost SA([0, 4]) = 9.
  const auto place = r.search(removed.nodes[0], removed.old_slot);
  EXPECT_EQ(place.slot, 3U);
  EXPECT_FLOAT_EQ(place.cost, 7);
}

TEST(Reinsertion, InsertMergesAndEnlargesTheAncestors) {
  PairTree tree(four_bars());
  Reinsertion<SurfaceArea> r(tree, area);
  const auto removed = r.remove_child(3, 1);  // D; C stands in Q's place
  EXPECT_EQ(removed.free, 3U);
  EXPECT_EQ(removed.old_slot, q_slot);
  EXPECT_EQ(box_at(tree, q_slot), bar(10, 11));
  EXPECT_EQ(box_at(tree, root), bar(0, 11));
  EXPECT_DOUBLE_EQ(r.inner_sum(), 23 + 7);
  r.insert(removed.node, a_slot, removed.free);
  EXPECT_EQ(tree.pairs[2].link[0], 3U);
  EXPECT_EQ(tree.up[3], a_slot);
  EXPECT_EQ(box_at(tree, a_slot), bar(0, 13));
  EXPECT_EQ(box_at(tree, p_slot), bar(0, 13));
  EXPECT_EQ(box_at(tree, root), bar(0, 13));
  EXPECT_DOUBLE_EQ(r.inner_sum(), 3 * 27);
}

/// Algorithm 1 without the bounds: the least cost over every slot, summed from the root down.
float least_cost_of_all(const PairTree& tree, const PairTree::Node& l, std::uint32_t slot, float induced) {
  const PairTree::Node x = tree.node(slot);
  const float merged = measure_both(area, united(x.box, l.box))[0];
  float least = induced + merged;
  if (!x.is_leaf()) {
    const float below = induced + (merged - x.measure);
    least = std::min(least, least_cost_of_all(tree, l, 2 * x.link, below));
    least = std::min(least, least_cost_of_all(tree, l, 2 * x.link + 1, below));
  }
  return least;
}

TEST(Reinsertion, SearchEqualsAnExhaustiveOne) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = test::scene_of(test::random_boxes(10 * seed, seed));
    PairTree tree(test::random_tree(scene, seed));
    Reinsertion<SurfaceArea> r(tree, area);
    for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) {
      if (n == tree.root()) continue;
      const auto removed = r.remove(n);
      for (std::size_t i = 0; i < 2; ++i) {
        const auto& l = removed.nodes[i];
        const auto found = r.search(l, removed.old_slot);
        ASSERT_EQ(found.cost, least_cost_of_all(tree, l, 0, 0)) << "seed " << seed << ", node " << n;
        ASSERT_NEAR(found.cost, r.merge_cost(l, found.slot), 1e-5F * found.cost);
        r.insert(l, found.slot, removed.free[i]);
      }
    }
    EXPECT_NEAR(r.inner_sum(), inner_measure_sum(tree), 1e-12 * r.inner_sum());
  }
}

TEST(Reinsertion, KeepsTheTreeValid) {
  const Scene scene = test::scene_of(test::random_boxes(200, 3));
  const Bvh2 first = test::random_tree(scene, 3);
  PairTree tree(first);
  Reinsertion<SurfaceArea> r(tree, area);
  for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) {
    if (n == tree.root()) continue;
    if (n % 2 == 0) {
      r.update_both(n);
    } else {
      r.update_larger(n);
    }
    Bvh2 bvh = first;
    tree.write_to(bvh);
    ASSERT_TRUE(find_problems(bvh, scene).empty()) << find_problems(bvh, scene)[0];
  }
}

TEST(Reinsertion, OfOneChildNeverRaisesTheCost) {
  const Scene scene = test::scene_of(test::random_boxes(300, 5));
  PairTree tree(test::random_tree(scene, 5));
  Reinsertion<SurfaceArea> r(tree, area);
  for (int round = 0; round < 5; ++round) {
    for (std::uint32_t n = 1; n <= tree.inner_count(); ++n) {
      if (n == tree.root()) continue;
      const double before = r.inner_sum();
      r.update_larger(n);
      ASSERT_LE(r.inner_sum(), before * (1 + 1e-7));  // the search compares sums of floats
    }
  }
}

}  // namespace
}  // namespace raystudy::insertion
