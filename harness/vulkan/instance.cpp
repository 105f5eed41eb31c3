#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <cstring>

#include "harness/base/unsupported.h"
#include "harness/vulkan/impl.h"

namespace raystudy::vulkan {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

bool wants_validation() {
  const char* value = std::getenv("RAYSTUDY_VULKAN_VALIDATION");
  if (value == nullptr || std::strcmp(value, "0") == 0 || *value == '\0') return false;
  if (std::strcmp(value, "1") == 0) return true;
  throw Error(Diagnostic{{}, fmt::format("RAYSTUDY_VULKAN_VALIDATION is '{}'", value), "0 or 1", {}});
}

vk::raii::Context load() {
  try {
    return {};
  } catch (const std::exception&) {
    throw Unsupported("there is no Vulkan loader (libvulkan.so.1) on this machine");
  }
}

std::string type_name(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu: return "discrete";
    case vk::PhysicalDeviceType::eIntegratedGpu: return "integrated";
    case vk::PhysicalDeviceType::eVirtualGpu: return "virtual";
    case vk::PhysicalDeviceType::eCpu: return "cpu";
    default: return "other";
  }
}

/// What of Raystudy's needs the device lacks, joined by commas.
std::string unfit(const vk::raii::PhysicalDevice& physical, const vk::PhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) {
    return fmt::format("Vulkan 1.2 (it has {}.{})", VK_API_VERSION_MAJOR(properties.apiVersion),
                       VK_API_VERSION_MINOR(properties.apiVersion));
  }
  const auto features = physical.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features>();
  const auto& more = features.get<vk::PhysicalDeviceVulkan12Features>();
  std::string lacks;
  const auto need = [&lacks](bool has, const char* what) {
    if (!has) lacks += fmt::format("{}{}", lacks.empty() ? "" : ", ", what);
  };
  need(more.bufferDeviceAddress != 0, "bufferDeviceAddress");
  need(more.scalarBlockLayout != 0, "scalarBlockLayout");
  need(more.hostQueryReset != 0, "hostQueryReset");
  bool computes = false;
  for (const vk::QueueFamilyProperties& family : physical.getQueueFamilyProperties()) {
    computes = computes || ((family.queueFlags & vk::QueueFlagBits::eCompute) && family.timestampValidBits > 0);
  }
  need(computes, "a compute queue with timestamps");
  return lacks;
}

}  // namespace

Instance::Instance() : context_(load()) {
  const bool validate = wants_validation();
  vk::ApplicationInfo application("raystudy", 1, "raystudy", 1, VK_API_VERSION_1_2);
  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  const std::array on{vk::ValidationFeatureEnableEXT::eSynchronizationValidation};
  vk::ValidationFeaturesEXT features(on, {});
  vk::InstanceCreateInfo create({}, &application, layers, extensions);
  if (validate) {
    bool there = false;
    for (const vk::LayerProperties& layer : context_.enumerateInstanceLayerProperties()) {
      there = there || std::strcmp(layer.layerName, validation_layer) == 0;
    }
    if (!there) throw Unsupported("RAYSTUDY_VULKAN_VALIDATION=1, but the Khronos validation layer is not installed");
    layers.push_back(validation_layer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    create = vk::InstanceCreateInfo({}, &application, layers, extensions, &features);
  }
  try {
    instance_.emplace(context_, create);
  } catch (const vk::SystemError& error) {
    throw Unsupported(fmt::format("there is no Vulkan driver on this machine ({})", error.what()));
  }
  if (!validate) return;
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  messenger_.emplace(*instance_, vk::DebugUtilsMessengerCreateInfoEXT({}, Severity::eWarning | Severity::eError,
                                                                      Type::eValidation | Type::ePerformance, on_message, this));
}

VkBool32 Instance::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
  auto& instance = *static_cast<Instance*>(self);
  const std::lock_guard lock(instance.mutex_);
  instance.messages_ += fmt::format("{}{}", instance.messages_.empty() ? "" : "\n", data->pMessage);
  return VK_FALSE;
}

std::string Instance::take_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

std::vector<vk::raii::PhysicalDevice> Instance::devices() const {
  try {
    auto found = vk::raii::PhysicalDevices(*instance_);
    return {std::make_move_iterator(found.begin()), std::make_move_iterator(found.end())};
  } catch (const vk::SystemError&) {
    return {};  // the loader says so where there is no driver
  }
}

DeviceInfo describe(const vk::raii::PhysicalDevice& physical) {
  const auto properties = physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                                  vk::PhysicalDeviceVulkan11Properties>();
  const vk::PhysicalDeviceProperties& core = properties.get<vk::PhysicalDeviceProperties2>().properties;
  const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
  DeviceInfo info;
  info.name = core.deviceName.data();
  info.driver = fmt::format("{} {}", driver.driverName.data(), driver.driverInfo.data());
  info.type = type_name(core.deviceType);
  info.subgroup_size = properties.get<vk::PhysicalDeviceVulkan11Properties>().subgroupSize;
  const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
    const vk::MemoryHeap& heap = memory.memoryHeaps.at(i);
    if (heap.flags & vk::MemoryHeapFlagBits::eDeviceLocal) info.memory = std::max<std::uint64_t>(info.memory, heap.size);
  }
  info.unfit = unfit(physical, core);
  return info;
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> list;
  try {
    const Instance instance;
    for (const vk::raii::PhysicalDevice& physical : instance.devices()) list.push_back(describe(physical));
  } catch (const Unsupported&) {
    return {};
  }
  return list;
}

}  // namespace raystudy::vulkan
