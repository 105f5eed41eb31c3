#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/method/cost_model.h"
#include "harness/method/params.h"
#include "harness/scene/scene.h"

namespace raystudy::topdown {

/// A part of the tree under construction: its node, and the `count` triangles at `begin` in the final order of triangles. The
/// slots of its descendants begin at `pairs` and are as many as single-triangle leaves need, 2 · count - 2, so that where a node
/// ends up depends on the triangles alone and not on which thread came first.
struct Subtree {
  std::uint32_t node = 0;
  std::uint32_t pairs = 2;
  std::uint32_t begin = 0;
  std::uint32_t count = 0;

  [[nodiscard]] Subtree left(std::uint32_t left_count) const { return {pairs, pairs + 2, begin, left_count}; }
  [[nodiscard]] Subtree right(std::uint32_t left_count) const {
    return {pairs + 1, pairs + 2 * left_count, begin + left_count, count - left_count};
  }
};

/// When a node becomes a leaf.
struct LeafPolicy {
  bool sah = false;                 ///< false: at one triangle only
  std::uint32_t max_triangles = 1;  ///< with sah: a node of more is always split
  float traversal = 3;              ///< c_T
  float intersection = 2;           ///< c_I

  LeafPolicy(const Params& params, const CostModel& cost);
  /// The parameters `leaves` and `max_leaf_triangles`, which the constructor reads.
  [[nodiscard]] static std::vector<ParamSpec> params();

  /// Whether a leaf costs no more than the best split: c_I · m · n <= c_T · m + c_I · split_cost.
  [[nodiscard]] bool is_leaf(std::uint32_t n, float measure, float split_cost) const {
    return sah && n <= max_triangles &&
           intersection * measure * static_cast<float>(n) <= traversal * measure + intersection * split_cost;
  }
};

}  // namespace raystudy::topdown
