#pragma once

#include <cstdint>
#include <span>

#include "methods/lbvh/order.h"

namespace raystudy::lbvh {

/// The inner nodes that Karras 2012, Fig. 4 finds, each apart from the others: node i has a range that begins or ends at place i.
class RadixTree {
 public:
  /// `codes` are read here only.
  template <class Code>
  RadixTree(std::span<const Code> codes, std::uint32_t max_leaf_triangles, int threads);

  [[nodiscard]] std::uint32_t leaves() const { return leaves_; }

  /// Makes the nodes, of which there is room for two a leaf: the children of all inner nodes at once, and then the boxes from the
  /// leaves up; of the two children of a node the one that comes last goes on (Sec. 4).
  void write(const Scene& scene, std::span<const std::uint32_t> order, int threads, Bvh2Node* nodes) const;

 private:
  struct Node {
    std::uint32_t begin;  ///< places of its range
    std::uint32_t end;
    std::uint32_t split;  ///< the last place of the first child
  };

  void count_leaves(int threads);
  [[nodiscard]] bool is_leaf(std::uint32_t begin, std::uint32_t end) const { return end - begin <= most_; }
  [[nodiscard]] std::uint32_t pair_of(const Node& node) const { return leaf_[node.split]; }
  void link(std::uint32_t begin, std::uint32_t end, std::uint32_t node, std::uint32_t slot, Bvh2Node* nodes,
            std::uint32_t* parents) const;

  std::uint32_t count_;
  std::uint32_t most_;
  std::uint32_t leaves_ = 1;
  AlignedRoom<Node> nodes_;
  AlignedRoom<std::uint32_t> leaf_;  ///< by place: the number of its leaf
};

}  // namespace raystudy::lbvh
