#pragma once

// The vulkan.hpp side of the device layer, for its own sources only: the header takes seconds to compile.

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vulkan/vulkan_raii.hpp>

#include "harness/base/error.h"
#include "harness/vulkan/buffer.h"
#include "harness/vulkan/device.h"

namespace raystudy::vulkan {

/// An instance and what its validation layer says.
class Instance {
 public:
  /// Throws Unsupported where there is no Vulkan loader or driver.
  Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  [[nodiscard]] std::vector<vk::raii::PhysicalDevice> devices() const;
  /// The messages since the last call.
  std::string take_messages();

 private:
  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT types,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* self);

  vk::raii::Context context_;
  std::optional<vk::raii::Instance> instance_;
  std::optional<vk::raii::DebugUtilsMessengerEXT> messenger_;
  std::mutex mutex_;
  std::string messages_;
};

[[nodiscard]] DeviceInfo describe(const vk::raii::PhysicalDevice& physical);

/// A compute pipeline. Its only interface are push constants of up to 128 bytes.
class Kernel {
 public:
  Kernel(DeviceImpl& device, std::string_view name, const Constants& constants, std::uint32_t subgroup_size);

  [[nodiscard]] vk::Pipeline pipeline() const { return *pipeline_; }
  [[nodiscard]] vk::PipelineLayout layout() const { return *layout_; }

 private:
  vk::raii::PipelineLayout layout_;
  vk::raii::Pipeline pipeline_;
};

/// Push constants that every device has room for.
constexpr std::uint32_t push_bytes = 128;

struct DeviceImpl {
  explicit DeviceImpl(std::string_view choice);

  /// Runs `commands` and waits. Throws Error where the device is lost or does not finish in time.
  void submit_and_wait(vk::CommandBuffer commands);
  /// Throws Error with what the validation layer said since the last time.
  void check_messages();
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted) const;

  Instance instance;
  vk::raii::PhysicalDevice physical;
  DeviceInfo info;
  vk::PhysicalDeviceLimits limits;
  std::uint32_t min_subgroup = 0;
  std::uint32_t max_subgroup = 0;
  std::uint32_t family = 0;
  bool doubles = false;
  double timestamp_seconds = 0;  ///< of one tick
  std::uint64_t timestamp_mask = 0;
  std::optional<vk::raii::Device> device;
  std::optional<vk::raii::Queue> queue;
  std::optional<vk::raii::CommandPool> pool;
  std::optional<vk::raii::QueryPool> queries;
  std::unique_ptr<Buffer> staging;
  std::map<std::tuple<std::string, Constants, std::uint32_t>, std::unique_ptr<Kernel>> kernels;
  std::size_t bytes = 0;
  std::size_t peak_bytes = 0;
  bool lost = false;
};

/// Marks of one Commands.
constexpr std::uint32_t most_marks = 4096;

/// Does `work`, turning what Vulkan throws into Error: "doing: reason".
template <class Work>
auto checked(std::string_view doing, const Work& work) {
  try {
    return work();
  } catch (const vk::SystemError& error) {
    throw Error(std::string(doing) + ": " + error.what());
  }
}

}  // namespace raystudy::vulkan
