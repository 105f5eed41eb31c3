#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "harness/accel/wide_bvh.h"
#include "tests/support/trees.h"

namespace raystudy::test {

/// Six triangles in a row along x, from 2 i to 2 i + 1. The root has a node with the leaves {0, 1} and {2}, then the leaves {3,
/// 4} and {5}. All planes are integers from 0 to 11, which the grid of 8 bits holds exactly.
template <class Node>
struct HandMade {
  static constexpr bool quantized = requires(const Node& n) { n.exponent; };

  Scene scene = scene_of(boxes());
  WideBvh bvh;

  HandMade() {
    auto& nodes = bvh.nodes.template emplace<WideBvh::NodeArray<Node>>(2);
    nodes[0] = node_of({{0, 5}, {6, 9}, {10, 11}});
    nodes[1] = node_of({{0, 3}, {4, 5}});
    nodes[1].child[0] = leaf({0, 1});
    nodes[1].child[1] = leaf({2});
    nodes[0].child[0] = 1;
    nodes[0].child[1] = leaf({3, 4});
    nodes[0].child[2] = leaf({5});
    for (Node& node : nodes) {
      for (auto& row : node.order) std::iota(row.begin(), row.end(), std::uint8_t{0});
    }
    bvh.corners.resize(bvh.corners.size() + WideBvh::padding);
    bvh.bounds = scene.bounds;
    bvh.height = 2;
  }

  Node& node(std::size_t i) { return std::get<WideBvh::NodeArray<Node>>(bvh.nodes)[i]; }
  void set_box(std::size_t node_index, std::size_t slot, const Box& box) { put(node(node_index), slot, box); }

 private:
  struct Range {
    float from;
    float to;
  };

  static std::vector<Box> boxes() {
    std::vector<Box> all;
    for (int i = 0; i < 6; ++i)
      all.emplace_back(Vec3{2.0F * static_cast<float>(i), 0, 0}, Vec3{2.0F * static_cast<float>(i) + 1, 1, 1});
    return all;
  }

  static void put(Node& node, std::size_t slot, const Box& box) {
    for (int axis = 0; axis < 3; ++axis) {
      auto& [lower, upper] = node.bounds[static_cast<std::size_t>(axis)];
      using Plane = std::remove_reference_t<decltype(lower[0])>;
      lower[slot] = static_cast<Plane>(box.lower[axis]);
      upper[slot] = static_cast<Plane>(box.upper[axis]);
    }
  }

  /// Used slots with these ranges of x.
  static Node node_of(const std::vector<Range>& ranges) {
    Node node{};
    if constexpr (quantized) node.exponent[3] = static_cast<std::int8_t>(ranges.size());
    for (std::size_t i = 0; i < Node::width; ++i) {
      if (i < ranges.size()) {
        put(node, i, {{ranges[i].from, 0, 0}, {ranges[i].to, 1, 1}});
      } else {
        if constexpr (!quantized) put(node, i, {});
        node.child[i] = WideChild::none;
      }
    }
    return node;
  }

  std::uint32_t leaf(const std::vector<std::uint32_t>& triangles) {
    const auto first = static_cast<std::uint32_t>(bvh.triangles.size());
    const auto n = static_cast<std::uint32_t>(triangles.size());
    bvh.corners.resize(std::size_t{9} * (first + n));
    for (std::uint32_t k = 0; k < n; ++k) {
      for (int corner = 0; corner < 3; ++corner) {
        const Vec3 v = scene.vertices[scene.triangles[triangles[k]][corner]];
        for (int axis = 0; axis < 3; ++axis) bvh.corners[WideBvh::row(first, n, axis, corner) + k] = v[axis];
      }
      bvh.triangles.push_back(triangles[k]);
    }
    return WideChild::leaf(first, n);
  }
};

}  // namespace raystudy::test
