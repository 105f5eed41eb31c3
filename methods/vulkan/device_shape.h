#pragma once

#include <cstdint>

#include "harness/vulkan/device.h"

namespace raystudy::gpu {

/// How work is cut for a device. A GPU wants many small invocations in groups that hide latency. A processor runs a workgroup on
/// one core, a vector of invocations at a time, and barriers make it switch between the vectors: its groups are one vector, and
/// each invocation has much to do. To llvmpipe (Mesa 22.3) a barrier for memory alone is one for control, too: where only some of
/// the invocations reach it, the group must be one vector.
struct DeviceShape {
  std::uint32_t group;        ///< invocations of a workgroup of kernels that share little or no memory
  std::uint32_t climb_group;  ///< of kernels whose invocations climb a tree and stop one after another
  std::uint32_t items;        ///< triangles of an invocation, where it may have several
  std::uint32_t scan_group;   ///< of prefix sums
  std::uint32_t scan_items;   ///< numbers that an invocation sums up
  std::uint32_t sort_group;   ///< of radix sorts
  std::uint32_t sort_items;   ///< keys of an invocation
  std::uint32_t digit_bits;   ///< of a digit at most; counters take 4 · sort_group << digit_bits bytes of shared memory
};

[[nodiscard]] inline DeviceShape shape_of(const vulkan::Device& device) {
  if (device.info().type == "cpu") return {64, device.info().subgroup_size, 16, 8, 64, 8, 1024, 8};
  return {128, 128, 1, 128, 16, 128, 16, 4};
}

[[nodiscard]] inline std::uint64_t groups_for(std::uint64_t count, std::uint64_t group) { return (count + group - 1) / group; }

}  // namespace raystudy::gpu
