#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/prefix_sum.h"
#include "methods/vulkan/sah_memory.h"

namespace raystudy::gpu {

/// Splits of nodes that are too large for one workgroup. Each stage is a kernel that several workgroups of a node run, one a
/// segment of its triangles; the nodes of a level share the stages.
class LargeSplits {
 public:
  /// Most triangles of a segment, and of a node that one workgroup splits. Mesa's processor driver ends the loops of an
  /// invocation after 65,535 rounds, and says nothing.
  static constexpr std::uint32_t segment = 8192;

  LargeSplits(vulkan::Device& device, const SahMemory& memory, const SahParams& params, std::uint32_t count);

  /// The most such nodes of a level, in a scene of `count` triangles.
  [[nodiscard]] static std::uint32_t most_nodes(std::uint32_t count) { return count / (segment + 1); }

  /// Finds the splits of nodes of one level and writes their children. The commands end with a barrier, as those below do.
  void record_splits(vulkan::Commands& commands, std::span<const SahNode> nodes) const;
  void record_reorder(vulkan::Commands& commands, std::span<const SahNode> nodes) const;
  void record_results(vulkan::Commands& commands, std::span<const SahNode> nodes) const;
  /// The children, once the commands have run; none of what became a leaf.
  [[nodiscard]] std::vector<SahNode> children(std::span<const SahNode> nodes) const;

 private:
  [[nodiscard]] vulkan::Slice minima(std::size_t i) const { return minima_.part(i * minima_bytes_, minima_bytes_); }
  [[nodiscard]] vulkan::Slice maxima(std::size_t i) const { return maxima_.part(i * maxima_bytes_, maxima_bytes_); }

  const SahMemory& memory_;
  SahParams params_;
  std::uint32_t count_;
  PrefixSum sum_;
  std::uint32_t group_;
  const vulkan::Kernel& bounds_;
  const vulkan::Kernel& test_;
  const vulkan::Kernel& choose_;
  const vulkan::Kernel& flags_;
  const vulkan::Kernel& scatter_;
  std::size_t minima_bytes_;  ///< of a node
  std::size_t maxima_bytes_;
  vulkan::Arena arena_;
  vulkan::Buffer readback_;
  vulkan::Slice minima_;
  vulkan::Slice maxima_;
  vulkan::Slice results_;
  vulkan::Slice sums_room_;
  vulkan::Slice moved_;  ///< indices in their new order
};

/// Constants of the kernels that have candidates: size of the workgroup, `samples`, candidates of an invocation, `segment`.
[[nodiscard]] vulkan::Constants candidate_constants(const vulkan::Device& device, std::uint32_t samples);

}  // namespace raystudy::gpu
