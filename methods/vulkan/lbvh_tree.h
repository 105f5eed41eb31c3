#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/lbvh_leaves.h"

namespace raystudy::gpu {

enum class Construction : std::uint8_t { karras, apetrei };

/// The hierarchy that the highest differing bits of Morton codes make, on a device: methods/lbvh/README.md defines it and where
/// its nodes stand.
class LbvhTree {
 public:
  /// `leaves` have been found.
  LbvhTree(vulkan::Device& device, const LbvhLeaves& leaves, Construction construction);

  /// Parts "hierarchy" and, by Karras, "boxes", added to `parts`.
  void build(std::vector<vulkan::PartTime>& parts);

  [[nodiscard]] vulkan::Slice nodes() const { return nodes_.all(); }

 private:
  void record_karras(vulkan::Commands& commands) const;

  vulkan::Device& device_;
  const LbvhLeaves& leaves_;
  Construction construction_;
  vulkan::Buffer nodes_;
  vulkan::Buffer slots_;  ///< by Karras: of each split, where the node that it splits stands
};

}  // namespace raystudy::gpu
