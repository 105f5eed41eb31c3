#include "methods/vulkan/radix_sort.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace raystudy::gpu {
namespace {

struct CountPush {
  std::uint64_t words;
  std::uint64_t counts;
  std::uint32_t count;
  std::uint32_t tiles;
  std::uint32_t tile_items;
  std::uint32_t shift;
};
struct MovePush {
  std::uint64_t from_low;
  std::uint64_t from_high;
  std::uint64_t from_values;
  std::uint64_t to_low;
  std::uint64_t to_high;
  std::uint64_t to_values;
  std::uint64_t starts;
  std::uint32_t count;
  std::uint32_t tiles;
  std::uint32_t tile_items;
  std::uint32_t shift;
  std::uint32_t high;
};

std::uint64_t address(const vulkan::Slice& slice) { return slice.buffer == nullptr ? 0 : slice.address(); }

}  // namespace

RadixSort::RadixSort(vulkan::Device& device, std::uint32_t first_bit, std::uint32_t end_bit, const DeviceShape& shape)
    : shape_(shape), sum_(device, shape) {
  if (first_bit >= end_bit || end_bit > 64) throw std::logic_error("a radix sort by no bits, or by more than there are");
  if (first_bit < 32) add_digits(device, shape, first_bit, std::min(end_bit, 32U), false, end_bit > 32);
  if (end_bit > 32) add_digits(device, shape, std::max(first_bit, 32U) - 32, end_bit - 32, true, true);
}

/// As few digits as can be, of sizes as equal as can be.
void RadixSort::add_digits(vulkan::Device& device, const DeviceShape& shape, std::uint32_t first_bit, std::uint32_t end_bit,
                           bool high, bool two_words) {
  const std::uint32_t passes = (end_bit - first_bit + shape.digit_bits - 1) / shape.digit_bits;
  for (std::uint32_t pass = 0; pass < passes; ++pass) {
    const std::uint32_t begin = first_bit + (end_bit - first_bit) * pass / passes;
    const std::uint32_t end = first_bit + (end_bit - first_bit) * (pass + 1) / passes;
    const std::uint32_t digits = 1U << (end - begin);
    const std::uint32_t numbered = digits_.empty() ? 1 : 0;
    const std::string alone = shape.sort_alone ? "_alone" : "";
    digits_.push_back(
        {begin, high, digits, &device.kernel("radix_count" + alone, {shape.sort_group, shape.sort_items, digits}),
         &device.kernel("radix_move" + alone, {shape.sort_group, shape.sort_items, digits, two_words ? 1U : 0U, numbered})});
  }
}

/// Alone, an invocation has counts of every digit to itself: few invocations, and as many items as keep the loop below the 65535
/// rounds after which llvmpipe ends it.
std::uint32_t RadixSort::tile_of(std::uint32_t n) const {
  return shape_.sort_alone ? std::clamp(n / 256, shape_.sort_items, 32768U) : shape_.sort_group * shape_.sort_items;
}

std::uint32_t RadixSort::tiles_of(std::uint32_t n) const { return static_cast<std::uint32_t>(groups_for(n, tile_of(n))); }

std::size_t RadixSort::room_for(std::uint32_t n) const {
  const auto most =
      std::max_element(digits_.begin(), digits_.end(), [](const Digit& a, const Digit& b) { return a.digits < b.digits; });
  const std::size_t counts = std::size_t{most->digits} * tiles_of(n);
  return vulkan::Arena::bytes_for({(counts + 1) * sizeof(std::uint32_t), sum_.room_for(counts)});
}

const SortItems& RadixSort::record(vulkan::Commands& commands, const SortItems& items, const SortItems& other, std::uint32_t n,
                                   const vulkan::Slice& room) const {
  const std::uint32_t tiles = tiles_of(n);
  const std::uint64_t groups = shape_.sort_alone ? groups_for(tiles, shape_.sort_group) : tiles;
  const SortItems* from = &items;
  const SortItems* to = &other;
  for (const Digit& digit : digits_) {
    const std::uint32_t counts = digit.digits * tiles;
    const vulkan::Slice starts = room.part(0, (std::size_t{counts} + 1) * sizeof(std::uint32_t));
    const std::size_t used = vulkan::Arena::bytes_for({starts.bytes});
    if (shape_.sort_alone) {
      commands.fill(starts, 0);
      commands.barrier();
    }
    commands.run(*digit.count,
                 CountPush{address(digit.high ? from->high : from->low), starts.address(), n, tiles, tile_of(n), digit.shift},
                 groups);
    commands.barrier();
    sum_.record(commands, starts, counts, room.part(used, room.bytes - used));
    commands.run(*digit.move,
                 MovePush{address(from->low), address(from->high), address(from->values), address(to->low), address(to->high),
                          address(to->values), starts.address(), n, tiles, tile_of(n), digit.shift, digit.high ? 1U : 0U},
                 groups);
    commands.barrier();
    std::swap(from, to);
  }
  return *from;
}

}  // namespace raystudy::gpu
