#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/morton_order.h"

namespace raystudy::gpu {

/// Parallel locally-ordered clustering (Meister and Bittner 2018) on a device; the tree of methods/ploc, node by node.
class PlocTree {
 public:
  /// `order` has been built.
  PlocTree(vulkan::Device& device, const MortonOrder& order, std::uint32_t radius);

  /// Parts "nearest", "merge" and "layout", added to `parts`. The host reads the number of clusters, a word, after every round.
  void build(std::vector<vulkan::PartTime>& parts);

  [[nodiscard]] const vulkan::Slice& nodes() const { return nodes_; }
  [[nodiscard]] const vulkan::Slice& triangles() const { return triangles_; }

 private:
  /// Clusters in Morton order.
  struct Clusters {
    vulkan::Slice boxes;
    vulkan::Slice links;
  };

  void record_round(vulkan::Commands& commands, std::uint32_t count, std::uint32_t merges) const;
  void record_layout(vulkan::Commands& commands, bool root, std::uint32_t first, std::uint32_t end) const;

  vulkan::Device& device_;
  const MortonOrder& order_;
  std::uint32_t radius_;
  PrefixSum sum_;
  vulkan::Arena arena_;
  vulkan::Slice nodes_;
  vulkan::Slice triangles_;
  vulkan::Slice merged_;  ///< pairs of siblings in the order of merges, the last first
  vulkan::Slice leaves_;
  vulkan::Slice places_;
  vulkan::Slice nearest_;
  vulkan::Slice marks_;
  vulkan::Slice sum_room_;
  Clusters clusters_;
  Clusters next_;
};

}  // namespace raystudy::gpu
