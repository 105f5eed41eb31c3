#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/morton_order.h"

namespace raystudy::gpu {

enum class Construction : std::uint8_t { karras, apetrei };

/// The hierarchy that the highest differing bits of Morton codes make, on a device: methods/lbvh/README.md defines it and where
/// its nodes stand.
class LbvhTree {
 public:
  /// `order` has been built.
  LbvhTree(vulkan::Device& device, const MortonOrder& order, std::uint32_t max_leaf_triangles, Construction construction);

  /// Parts "leaves", "hierarchy" and "boxes".
  [[nodiscard]] std::vector<vulkan::PartTime> build();

  [[nodiscard]] std::uint32_t leaf_count() const { return leaves_; }
  [[nodiscard]] vulkan::Slice nodes() const { return nodes_->all(); }

 private:
  void find_leaves(std::vector<vulkan::PartTime>& parts);
  void record_karras(vulkan::Commands& commands, const vulkan::Slice& slots, const vulkan::Slice& arrivals) const;

  vulkan::Device& device_;
  const MortonOrder& order_;
  std::uint32_t max_leaf_triangles_;
  Construction construction_;
  PrefixSum sum_;
  vulkan::Arena arena_;
  vulkan::Slice leaf_first_;
  vulkan::Slice leaf_depths_;
  vulkan::Slice depths_;  ///< of splits between leaves
  std::uint32_t leaves_;
  std::unique_ptr<vulkan::Buffer> nodes_;
};

}  // namespace raystudy::gpu
