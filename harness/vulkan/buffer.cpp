#include "harness/vulkan/buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <stdexcept>

#include "harness/vulkan/buffer_impl.h"
#include "harness/vulkan/commands.h"

namespace raystudy::vulkan {
namespace {

constexpr std::size_t staging_bytes = std::size_t{16} << 20U;

std::unique_ptr<Buffer::Impl> make_buffer(DeviceImpl& device, std::size_t bytes, Buffer::Kind kind) {
  const bool staging = kind == Buffer::Kind::staging;
  if (!staging && device.bytes + bytes > device.info.memory) {
    throw Error(fmt::format("{} has {} MiB of memory, of which {} are in use; {} more are needed", device.info.name,
                            device.info.memory >> 20U, device.bytes >> 20U, (bytes >> 20U) + 1));
  }
  const auto usage = vk::BufferUsageFlagBits::eTransferSrc | vk::BufferUsageFlagBits::eTransferDst |
                     (staging ? vk::BufferUsageFlags{}
                              : vk::BufferUsageFlagBits::eStorageBuffer | vk::BufferUsageFlagBits::eIndirectBuffer |
                                    vk::BufferUsageFlagBits::eShaderDeviceAddress);
  const auto wanted = staging ? vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent
                              : vk::MemoryPropertyFlags(vk::MemoryPropertyFlagBits::eDeviceLocal);
  try {
    auto impl = std::make_unique<Buffer::Impl>();
    impl->buffer.emplace(*device.device, vk::BufferCreateInfo({}, bytes, usage));
    const vk::MemoryRequirements needs = impl->buffer->getMemoryRequirements();
    const vk::MemoryAllocateFlagsInfo flags(vk::MemoryAllocateFlagBits::eDeviceAddress);
    vk::MemoryAllocateInfo allocate(needs.size, device.memory_type(needs.memoryTypeBits, wanted));
    if (!staging) allocate.pNext = &flags;
    impl->memory.emplace(*device.device, allocate);
    impl->buffer->bindMemory(**impl->memory, 0);
    impl->bytes = bytes;
    impl->device = &device;
    if (staging) {
      impl->mapped = static_cast<std::byte*>(impl->memory->mapMemory(0, VK_WHOLE_SIZE));
    } else {
      impl->address = device.device->getBufferAddress(vk::BufferDeviceAddressInfo(**impl->buffer));
      impl->counted = true;
      device.bytes += bytes;
      device.peak_bytes = std::max(device.peak_bytes, device.bytes);
    }
    return impl;
  } catch (const vk::SystemError& error) {
    throw Error(fmt::format("{}: no memory for a buffer of {} bytes ({})", device.info.name, bytes, error.what()));
  }
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

const Buffer& staging_of(Device& device) {
  std::unique_ptr<Buffer>& staging = device.impl().staging;
  if (!staging) staging = std::make_unique<Buffer>(device, staging_bytes, Buffer::Kind::staging);
  return *staging;
}

}  // namespace

std::uint64_t Slice::address() const { return buffer->address() + offset; }

Buffer::Buffer(Device& device, std::size_t bytes, Kind kind)
    : impl_(make_buffer(device.impl(), std::max<std::size_t>(bytes, 16), kind)) {}

Buffer::~Buffer() {
  if (impl_->counted) impl_->device->bytes -= impl_->bytes;
  if (impl_->device->lost) static_cast<void>(impl_.release());
}

std::uint64_t Buffer::address() const { return impl_->address; }
std::size_t Buffer::bytes() const { return impl_->bytes; }
std::byte* Buffer::mapped() const { return impl_->mapped; }

std::size_t Arena::bytes_for(std::initializer_list<std::size_t> sizes) {
  std::size_t sum = 0;
  for (const std::size_t size : sizes) sum += (size + alignment - 1) / alignment * alignment;
  return sum;
}

Slice Arena::take(std::size_t bytes) {
  if (used_ + bytes > buffer_.bytes()) throw std::logic_error("the arena is used up");
  const Slice slice = buffer_.all().part(used_, bytes);
  used_ += bytes_for({bytes});
  return slice;
}

double upload(Device& device, const Slice& to, std::span<const std::byte> from) {
  if (from.size() > to.bytes) throw std::logic_error("more is uploaded than there is room for");
  const auto start = std::chrono::steady_clock::now();
  const Buffer& staging = staging_of(device);
  for (std::size_t done = 0; done < from.size();) {
    const std::size_t size = std::min(staging.bytes(), from.size() - done);
    std::memcpy(staging.mapped(), from.data() + done, size);
    Commands commands(device);
    commands.copy(staging.all().part(0, size), to.part(done, size));
    commands.finish();
    done += size;
  }
  return seconds_since(start);
}

double download(Device& device, const Slice& from, std::span<std::byte> to) {
  if (to.size() > from.bytes) throw std::logic_error("more is downloaded than there is");
  const auto start = std::chrono::steady_clock::now();
  const Buffer& staging = staging_of(device);
  for (std::size_t done = 0; done < to.size();) {
    const std::size_t size = std::min(staging.bytes(), to.size() - done);
    Commands commands(device);
    commands.copy(from.part(done, size), staging.all().part(0, size));
    commands.finish();
    std::memcpy(to.data() + done, staging.mapped(), size);
    done += size;
  }
  return seconds_since(start);
}

}  // namespace raystudy::vulkan
