#pragma once

#include <cstdint>

#include "harness/vulkan/device.h"

namespace raystudy::gpu {

/// How work is cut for a device. A GPU wants many small invocations in groups that hide latency. A processor runs a workgroup on
/// one core, a vector of invocations at a time, and barriers make it switch between the vectors: its groups are one vector where
/// there are barriers, and each invocation has much to do.
struct DeviceShape {
  std::uint32_t group;       ///< invocations of a workgroup of kernels that share little or no memory
  std::uint32_t items;       ///< triangles of an invocation, where it may have several
  std::uint32_t scan_group;  ///< of kernels with barriers: prefix sums and others
  std::uint32_t scan_items;  ///< numbers that an invocation sums up
  std::uint32_t clusters;    ///< of PLOC, for which an invocation seeks the nearest at once
  bool sort_alone;  ///< radix sorts: an invocation moves a tile alone, and counts in memory; else a workgroup in shared memory
  std::uint32_t sort_group;  ///< of radix sorts
  std::uint32_t sort_items;  ///< keys of an invocation, alone at least
  std::uint32_t digit_bits;  ///< of a digit at most; in shared memory counters take 4 · sort_group << digit_bits bytes
  /// Whether memory that workgroups hand to each other within a kernel needs barriers beside the atomics. To llvmpipe (Mesa 22.3)
  /// a barrier for memory alone is one for control, too, and what other invocations of the workgroup had to do is lost; its
  /// atomics are sequentially consistent by themselves.
  bool fences;
};

[[nodiscard]] inline DeviceShape gpu_shape() {
  return {.group = 128,
          .items = 1,
          .scan_group = 128,
          .scan_items = 16,
          .clusters = 1,
          .sort_alone = false,
          .sort_group = 128,
          .sort_items = 16,
          .digit_bits = 4,
          .fences = true};
}

[[nodiscard]] inline DeviceShape processor_shape(const vulkan::DeviceInfo& info) {
  return {.group = 64,
          .items = 16,
          .scan_group = info.subgroup_size,
          .scan_items = 64,
          .clusters = 8,
          .sort_alone = true,
          .sort_group = info.subgroup_size,
          .sort_items = 1024,
          .digit_bits = 10,
          .fences = !info.driver.starts_with("llvmpipe")};
}

[[nodiscard]] inline DeviceShape shape_of(const vulkan::Device& device) {
  return device.info().type == "cpu" ? processor_shape(device.info()) : gpu_shape();
}

[[nodiscard]] inline std::uint64_t groups_for(std::uint64_t count, std::uint64_t group) { return (count + group - 1) / group; }

}  // namespace raystudy::gpu
