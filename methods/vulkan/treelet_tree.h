#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/lbvh_leaves.h"

namespace raystudy::gpu {

/// HLBVH-SAH: treelets as Morton codes make them, and over them a tree by a binned SAH, level by level with a queue of nodes:
/// methods/lbvh/README.md, 6 and 7.
class TreeletTree {
 public:
  /// `leaves` have been found; those of two treelets are parted by splits less deep than `least_depth`.
  TreeletTree(vulkan::Device& device, const LbvhLeaves& leaves, std::uint32_t least_depth, std::uint32_t bins);

  /// Parts "treelets", "hierarchy", "sah" and "layout", added to `parts`.
  void build(std::vector<vulkan::PartTime>& parts);

  [[nodiscard]] const vulkan::Slice& nodes() const { return nodes_; }
  [[nodiscard]] const vulkan::Slice& triangles() const { return triangles_; }

 private:
  void find_treelets(std::vector<vulkan::PartTime>& parts);
  void build_treelets(std::vector<vulkan::PartTime>& parts);
  void split(std::vector<vulkan::PartTime>& parts);
  void record_level(vulkan::Commands& commands);
  void lay_out(std::vector<vulkan::PartTime>& parts);

  vulkan::Device& device_;
  const LbvhLeaves& leaves_;
  std::uint32_t least_depth_;
  std::uint32_t bins_;
  PrefixSum sum_;
  vulkan::Arena arena_;
  vulkan::Slice nodes_;
  vulkan::Slice triangles_;
  vulkan::Slice treelet_nodes_;
  vulkan::Slice ends_;
  vulkan::Slice treelet_of_;     ///< of each leaf
  vulkan::Slice treelet_first_;  ///< the first leaf of each treelet
  vulkan::Slice sum_room_;
  std::uint32_t count_ = 0;  ///< treelets

  /// For the tree over the treelets.
  struct Top {
    Top(vulkan::Device& device, std::uint32_t treelets);
    vulkan::Arena arena;
    vulkan::Slice roots;
    vulkan::Slice places;
    vulkan::Slice queues;
    vulkan::Slice orders[2];
    vulkan::Slice tasks[2];
    std::uint32_t level = 0;  ///< which of the two is this level's
  };
  std::unique_ptr<Top> top_;
};

}  // namespace raystudy::gpu
