#include "harness/vulkan/device.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <numeric>

#include "harness/base/error.h"
#include "harness/base/unsupported.h"
#include "harness/vulkan/buffer.h"
#include "harness/vulkan/commands.h"

namespace raystudy::vulkan {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct IotaPush {
  std::uint64_t to;
  std::uint32_t count;
  std::uint32_t first;
};

std::vector<std::uint32_t> iota(std::size_t n, std::uint32_t first) {
  std::vector<std::uint32_t> all(n);
  std::iota(all.begin(), all.end(), first);
  return all;
}

class DeviceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
  std::vector<std::uint32_t> read(const Slice& slice) {
    std::vector<std::uint32_t> words(slice.bytes / 4);
    download(device(), slice, std::as_writable_bytes(std::span(words)));
    return words;
  }
  static Device& device() { return Device::shared(); }
};

TEST_F(DeviceTest, RunsAKernelOverMoreGroupsThanFitOneRow) {
  const std::uint32_t n = 4 * device().max_groups() + 5;
  const Buffer buffer(device(), n * 4);
  Commands commands(device());
  commands.mark("iota");
  commands.run(device().kernel("iota", {4}), IotaPush{buffer.address(), n, 7}, (n + 3) / 4);
  const std::vector<PartTime> parts = commands.finish();
  EXPECT_EQ(read(buffer.all()), iota(n, 7));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts.front().part, "iota");
  EXPECT_GT(parts.front().seconds, 0);
}

TEST_F(DeviceTest, RunsAsManyGroupsAsTheDeviceReads) {
  const Buffer buffer(device(), 256);
  const Buffer groups(device(), 12);
  const std::vector<std::uint32_t> numbers{3, 1, 1};
  upload(device(), groups.all(), std::span<const std::uint32_t>(numbers));
  Commands commands(device());
  commands.fill(buffer.all(), 1000);
  commands.barrier();
  commands.run_indirect(device().kernel("iota", {2}), IotaPush{buffer.address(), 64, 0}, groups.all());
  commands.finish();
  std::vector<std::uint32_t> expected = iota(6, 0);
  expected.resize(64, 1000);
  EXPECT_EQ(read(buffer.all()), expected);
}

TEST_F(DeviceTest, CopiesInPiecesWhatIsLargerThanStagingMemory) {
  const std::vector<std::uint32_t> words = iota(9U << 20U, 3);
  const Buffer buffer(device(), words.size() * 4);
  EXPECT_GT(upload(device(), buffer.all(), std::span<const std::uint32_t>(words)), 0);
  EXPECT_EQ(read(buffer.all()), words);
}

TEST_F(DeviceTest, CountsTheBytesOfItsBuffers) {
  const std::size_t before = device().bytes();
  device().reset_peak_bytes();
  {
    const Buffer one(device(), 1000);
    const Buffer two(device(), 500);
    EXPECT_EQ(device().bytes(), before + 1500);
  }
  EXPECT_EQ(device().bytes(), before);
  EXPECT_EQ(device().peak_bytes(), before + 1500);
}

TEST_F(DeviceTest, CutsAnArenaIntoAlignedSlices) {
  Arena arena(device(), Arena::bytes_for({10, 300}));
  const Slice one = arena.take(10);
  const Slice two = arena.take(300);
  EXPECT_EQ(two.address() - one.address(), Arena::alignment);
  EXPECT_THROW(arena.take(1), std::logic_error);
}

TEST_F(DeviceTest, SaysWhatMemoryItHasWhereABufferDoesNotFit) {
  const std::uint64_t all = device().info().memory;
  EXPECT_THAT([&] { Buffer(device(), all + 1); },
              ThrowsMessage<Error>(testing::AllOf(HasSubstr(device().info().name + " has "), HasSubstr(" more are needed"))));
}

TEST_F(DeviceTest, NamesTheDevicesThereAreWhereOneIsNot) {
  const std::vector<DeviceInfo> all = list_devices();
  EXPECT_THAT([] { Device("no-such-device"); },
              ThrowsMessage<Unsupported>(testing::AllOf(
                  HasSubstr("there is no device 'no-such-device'; expected a number below "), HasSubstr(all.front().name))));
  EXPECT_THAT([&] { Device(std::to_string(all.size())); }, ThrowsMessage<Unsupported>(HasSubstr("there is no device '")));
}

TEST_F(DeviceTest, TakesADeviceByNumberAndByName) {
  const std::vector<DeviceInfo> all = list_devices();
  EXPECT_EQ(Device("0").info().name, all.front().name);
  EXPECT_EQ(Device(all.front().name).info().driver, all.front().driver);
}

TEST_F(DeviceTest, AddsUpThePartsThatAreMarkedAgain) {
  const Buffer buffer(device(), 64);
  Commands commands(device());
  for (int i = 0; i < 2; ++i) {
    commands.mark("one");
    commands.run(device().kernel("iota", {8}), IotaPush{buffer.address(), 16, 0}, 2);
    commands.barrier();
    commands.mark("two");
    commands.fill(buffer.all(), 0);
    commands.barrier();
  }
  std::vector<std::string> names;
  for (const PartTime& part : commands.finish()) names.push_back(part.part);
  EXPECT_THAT(names, ElementsAre("one", "two"));
}

TEST_F(DeviceTest, ADeviceThatDoesNotFinishInTimeIsLost) {
  // Its memory must outlive it, so the device is not the one of the other tests.
  Device own("0");
  const Buffer buffer(own, 64U << 20U);
  Commands commands(own);
  for (int i = 0; i < 20; ++i) {
    commands.run(own.kernel("iota", {64}), IotaPush{buffer.address(), 16U << 20U, 0}, 1U << 18U);
    commands.barrier();
  }
  setenv("RAYSTUDY_DEVICE_TIMEOUT", "0.000001", 1);
  EXPECT_THAT([&] { commands.finish(); },
              ThrowsMessage<Error>(own.info().name + " did not finish within 1e-06 s (RAYSTUDY_DEVICE_TIMEOUT)"));
  unsetenv("RAYSTUDY_DEVICE_TIMEOUT");
  Commands more(own);
  EXPECT_THAT([&] { more.finish(); }, ThrowsMessage<Error>(own.info().name + " was lost before"));
}

TEST_F(DeviceTest, ATimeOutThatIsNoneIsBadInput) {
  setenv("RAYSTUDY_DEVICE_TIMEOUT", "soon", 1);
  Commands commands(device());
  EXPECT_THAT([&] { commands.finish(); },
              ThrowsMessage<Error>("RAYSTUDY_DEVICE_TIMEOUT is 'soon'; expected seconds, above 0 and at most 1000000"));
  unsetenv("RAYSTUDY_DEVICE_TIMEOUT");
}

TEST_F(DeviceTest, WhatTheValidationLayerSaysIsAnError) {
  if (std::getenv("RAYSTUDY_VULKAN_VALIDATION") == nullptr) GTEST_SKIP() << "RAYSTUDY_VULKAN_VALIDATION is not set";
  const Buffer buffer(device(), 64);
  Commands commands(device());
  commands.fill(buffer.all(), 1);
  commands.fill(buffer.all(), 2);  // without a barrier
  EXPECT_THAT([&] { commands.finish(); },
              ThrowsMessage<Error>(testing::AllOf(HasSubstr("Vulkan validation: "), HasSubstr("WRITE_AFTER_WRITE"))));
}

TEST_F(DeviceTest, AnUnknownShaderIsAMistakeOfTheProgrammer) { EXPECT_THROW(device().kernel("none"), std::logic_error); }

}  // namespace
}  // namespace raystudy::vulkan
