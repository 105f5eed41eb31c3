#pragma once

#include <cstddef>
#include <cstdint>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {

/// Prefix sums of 32-bit numbers on a device: sums of tiles, the sum before each tile, the sum before each number.
class PrefixSum {
 public:
  explicit PrefixSum(vulkan::Device& device) : PrefixSum(device, shape_of(device)) {}
  PrefixSum(vulkan::Device& device, const DeviceShape& shape);

  /// Bytes of `room` that n numbers take.
  [[nodiscard]] std::size_t room_for(std::uint64_t n) const;
  /// Puts the sum of all before it in place of each of the n numbers, and the sum of all behind the last: `values` has n + 1.
  /// The commands end with a barrier.
  void record(vulkan::Commands& commands, const vulkan::Slice& values, std::uint32_t n, const vulkan::Slice& room) const;

 private:
  [[nodiscard]] std::uint64_t tiles_of(std::uint64_t n) const;

  std::uint32_t tile_;
  const vulkan::Kernel& sum_tiles_;
  const vulkan::Kernel& sum_of_tiles_;
  const vulkan::Kernel& sum_before_;
};

}  // namespace raystudy::gpu
