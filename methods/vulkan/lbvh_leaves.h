#pragma once

#include <cstdint>
#include <vector>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/morton_order.h"

namespace raystudy::gpu {

/// The leaves of a hierarchy over Morton codes, found before the hierarchy itself. They are parted by the splits that are kept:
/// those in nodes of more than `max_leaf_triangles`, and those less deep than `least_depth`, where the keys beside the split have
/// fewer bits in common (shaders/lbvh.glsl).
class LbvhLeaves {
 public:
  LbvhLeaves(vulkan::Device& device, const MortonOrder& order, std::uint32_t max_leaf_triangles, std::uint32_t least_depth = 0);

  /// Part "leaves", added to `parts`. `order` has been built.
  void find(std::vector<vulkan::PartTime>& parts);

  [[nodiscard]] const MortonOrder& order() const { return order_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  /// Whether leaf k is place k, so that there is no list of leaves.
  [[nodiscard]] bool one_a_leaf() const { return one_a_leaf_; }
  /// Address of where each leaf begins, and behind the last: count + 1 words. 0 with one triangle a leaf.
  [[nodiscard]] std::uint64_t first() const { return one_a_leaf_ ? 0 : first_.address(); }
  /// Address of the depth of the split behind each leaf but the last.
  [[nodiscard]] std::uint64_t depths() const { return one_a_leaf_ ? order_.first_room().address() : depths_.address(); }

 private:
  vulkan::Device& device_;
  const MortonOrder& order_;
  std::uint32_t max_leaf_triangles_;
  std::uint32_t least_depth_;
  bool one_a_leaf_;
  std::uint32_t count_;
  PrefixSum sum_;
  vulkan::Arena arena_;
  vulkan::Slice first_;
  vulkan::Slice depths_;
  vulkan::Slice masks_;  ///< of the places behind which leaves end
  vulkan::Slice ranks_;  ///< of the masks: how many leaves end before
  vulkan::Slice sum_room_;
};

/// The depth of splits between codes of `bits` bits that have their first `prefix` bits in common, or more; splits less deep part
/// codes that have not.
[[nodiscard]] inline std::uint32_t depth_of_prefix(std::uint32_t bits, std::uint32_t prefix) { return 64 - bits + prefix; }

/// One of the words that a device has.
[[nodiscard]] std::uint32_t read_word(vulkan::Device& device, const vulkan::Slice& words, std::size_t index);

}  // namespace raystudy::gpu
