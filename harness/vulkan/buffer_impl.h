#pragma once

#include "harness/vulkan/buffer.h"
#include "harness/vulkan/impl.h"

namespace raystudy::vulkan {

struct Buffer::Impl {
  std::optional<vk::raii::DeviceMemory> memory;
  std::optional<vk::raii::Buffer> buffer;
  std::size_t bytes = 0;
  std::uint64_t address = 0;
  std::byte* mapped = nullptr;
  DeviceImpl* device = nullptr;
  bool counted = false;  ///< in the device's bytes
};

}  // namespace raystudy::vulkan
