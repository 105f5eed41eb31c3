#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "methods/vulkan/prefix_sum.h"
#include "methods/vulkan/radix_sort.h"

namespace raystudy::gpu {
namespace {

using vulkan::Device;
using vulkan::Slice;
using Words = std::vector<std::uint32_t>;

class DeviceSort : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
  static Device& device() { return Device::shared(); }
};

constexpr std::uint32_t sizes[] = {1, 2, 7, 8, 9, 511, 512, 513, 8191, 8192, 8193, 100'000};

Words read(const Slice& slice, std::size_t n) {
  Words words(n);
  vulkan::download(Device::shared(), slice, std::as_writable_bytes(std::span(words)));
  return words;
}

/// As the device likes it, as GPUs do, and small.
std::vector<DeviceShape> shapes() { return {shape_of(Device::shared()), gpu_shape(), {8, 1, 32, 2, 1, false, 32, 3, 5, true}}; }

void check_sums(const DeviceShape& shape, std::uint32_t n) {
  Device& device = Device::shared();
  const PrefixSum sum(device, shape);
  std::mt19937 random(1);
  Words values(n);
  for (std::uint32_t& value : values) value = random() % 5;
  const vulkan::Buffer buffer(device, (n + 1) * sizeof(std::uint32_t));
  const vulkan::Buffer room(device, sum.room_for(n));
  vulkan::upload(device, buffer.all(), std::span<const std::uint32_t>(values));
  vulkan::Commands commands(device);
  sum.record(commands, buffer.all(), n, room.all());
  commands.finish();
  Words expected{0};
  std::partial_sum(values.begin(), values.end(), std::back_inserter(expected));
  EXPECT_EQ(read(buffer.all(), n + 1), expected) << n;
}

TEST_F(DeviceSort, PrefixSumsOfAnyNumberOfValues) {
  for (const DeviceShape& shape : shapes()) {
    for (const std::uint32_t n : sizes) check_sums(shape, n);
  }
}

/// Sorts keys by the bits [first, end); checks keys and values against a stable sort of the standard library.
void check_sort(const DeviceShape& shape, const std::vector<std::uint64_t>& keys, std::uint32_t first, std::uint32_t end) {
  Device& device = Device::shared();
  const auto n = static_cast<std::uint32_t>(keys.size());
  const RadixSort sort(device, first, end, shape);
  const std::size_t bytes = n * sizeof(std::uint32_t);
  vulkan::Arena arena(device, vulkan::Arena::bytes_for({bytes, bytes, bytes, bytes, bytes, bytes, sort.room_for(n)}));
  const SortItems items{arena.take(bytes), arena.take(bytes), arena.take(bytes)};
  const SortItems other{arena.take(bytes), arena.take(bytes), arena.take(bytes)};
  Words low;
  Words high;
  for (const std::uint64_t key : keys) {
    low.push_back(static_cast<std::uint32_t>(key));
    high.push_back(static_cast<std::uint32_t>(key >> 32U));
  }
  vulkan::upload(device, items.low, std::span<const std::uint32_t>(low));
  vulkan::upload(device, items.high, std::span<const std::uint32_t>(high));
  vulkan::Commands commands(device);
  const SortItems& sorted = sort.record(commands, items, other, n, arena.take(sort.room_for(n)));
  commands.finish();

  Words expected(n);
  std::iota(expected.begin(), expected.end(), 0U);
  const std::uint64_t mask = end == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << end) - 1;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return (keys[a] & mask) >> first < (keys[b] & mask) >> first; });
  EXPECT_EQ(read(sorted.values, n), expected) << n << " keys, bits " << first << " to " << end;
  Words sorted_low;
  Words sorted_high;
  for (const std::uint32_t i : expected) {
    sorted_low.push_back(low[i]);
    sorted_high.push_back(high[i]);
  }
  EXPECT_EQ(read(sorted.low, n), sorted_low);
  if (end > 32) {
    EXPECT_EQ(read(sorted.high, n), sorted_high);
  }
}

TEST_F(DeviceSort, SortsStablyByAnyBits) {
  std::mt19937_64 random(2);
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> bits{{0, 30}, {0, 63}, {24, 30}, {30, 45}, {0, 1}};
  for (const DeviceShape& shape : shapes()) {
    for (const auto& [first, end] : bits) {
      for (const std::uint32_t n : sizes) {
        std::vector<std::uint64_t> keys(n);
        for (std::uint64_t& key : keys) key = random();
        check_sort(shape, keys, first, end);
      }
    }
  }
}

TEST_F(DeviceSort, KeepsTheOrderOfEqualKeys) {
  for (const DeviceShape& shape : shapes()) {
    check_sort(shape, std::vector<std::uint64_t>(20'000, 0x2aaaaaaaU), 0, 30);
    std::vector<std::uint64_t> two(20'000);
    for (std::size_t i = 0; i < two.size(); ++i) two[i] = i % 3 == 0 ? 5 : std::uint64_t{1} << 62U;
    check_sort(shape, two, 0, 63);
  }
}

}  // namespace
}  // namespace raystudy::gpu
