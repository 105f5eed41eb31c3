#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/device_shape.h"
#include "methods/vulkan/prefix_sum.h"

namespace raystudy::gpu {

/// Keys of one or two 32-bit words, and a value of 32 bits for each.
struct SortItems {
  vulkan::Slice low;
  vulkan::Slice high;  ///< not used where keys have one word
  vulkan::Slice values;
};

/// A stable radix sort on a device, from the least significant digit on. Each digit takes a kernel that counts digits by tile, a
/// prefix sum over the counts, and a kernel that moves the items.
class RadixSort {
 public:
  /// Sorts by the bits [first_bit, end_bit) of the keys; keys have two words where end_bit is above 32.
  RadixSort(vulkan::Device& device, std::uint32_t first_bit, std::uint32_t end_bit)
      : RadixSort(device, first_bit, end_bit, shape_of(device)) {}
  RadixSort(vulkan::Device& device, std::uint32_t first_bit, std::uint32_t end_bit, const DeviceShape& shape);

  /// Bytes of `room` that n items take.
  [[nodiscard]] std::size_t room_for(std::uint32_t n) const;
  /// Sorts n items; `items` and `other` are both written to, and the one that holds the result is returned. The values that
  /// `items` begins with are 0, 1, 2, ... and need not be there. The commands end with a barrier.
  [[nodiscard]] const SortItems& record(vulkan::Commands& commands, const SortItems& items, const SortItems& other,
                                        std::uint32_t n, const vulkan::Slice& room) const;

 private:
  struct Digit {
    std::uint32_t shift;  ///< within its word
    bool high;
    std::uint32_t digits;
    const vulkan::Kernel* count;
    const vulkan::Kernel* move;
  };

  void add_digits(vulkan::Device& device, const DeviceShape& shape, std::uint32_t first_bit, std::uint32_t end_bit, bool high,
                  bool two_words);
  /// Items of a tile, and how many tiles there are, of n items.
  [[nodiscard]] std::uint32_t tile_of(std::uint32_t n) const;
  [[nodiscard]] std::uint32_t tiles_of(std::uint32_t n) const;

  DeviceShape shape_;
  PrefixSum sum_;
  std::vector<Digit> digits_;
};

}  // namespace raystudy::gpu
