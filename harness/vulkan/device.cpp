#include "harness/vulkan/device.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>

#include "harness/base/unsupported.h"
#include "harness/vulkan/buffer.h"
#include "harness/vulkan/impl.h"
#include "harness/vulkan/shader.h"

namespace raystudy::vulkan {
namespace {

std::string& chosen() {
  static std::string choice = device_of_environment();
  return choice;
}

std::unique_ptr<Device>& shared_device() {
  static std::unique_ptr<Device> device;
  return device;
}

/// Waiting time in nanoseconds.
std::uint64_t time_out() {
  constexpr double usual = 30;
  const char* text = std::getenv("RAYSTUDY_DEVICE_TIMEOUT");
  if (text == nullptr) return static_cast<std::uint64_t>(usual * 1e9);
  double seconds = 0;
  const char* end = text + std::string_view(text).size();
  const auto [rest, error] = std::from_chars(text, end, seconds);
  if (error != std::errc() || rest != end || !(seconds > 0) || seconds > 1e6) {
    throw Error(Diagnostic{{}, fmt::format("RAYSTUDY_DEVICE_TIMEOUT is '{}'", text), "seconds, above 0 and at most 1000000", {}});
  }
  return static_cast<std::uint64_t>(seconds * 1e9);
}

/// The best of all that will do.
std::size_t best_of(const std::vector<DeviceInfo>& infos) {
  constexpr std::array<std::string_view, 5> order{"discrete", "integrated", "virtual", "cpu", "other"};
  std::string lacks;
  for (const std::string_view type : order) {
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (infos[i].type != type) continue;
      if (infos[i].unfit.empty()) return i;
      lacks += fmt::format("; {} lacks {}", infos[i].name, infos[i].unfit);
    }
  }
  throw Unsupported(fmt::format("there is no Vulkan device on this machine that will do{}", lacks));
}

/// By number or by name.
std::size_t find_device(const std::vector<DeviceInfo>& infos, std::string_view choice) {
  if (infos.empty()) throw Unsupported("there is no Vulkan device on this machine");
  if (choice.empty()) return best_of(infos);
  std::size_t index = infos.size();
  const auto [rest, error] = std::from_chars(choice.data(), choice.data() + choice.size(), index);
  const bool number = error == std::errc() && rest == choice.data() + choice.size();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < infos.size(); ++i) {
    names.push_back(infos[i].name);
    if (!number && infos[i].name == choice) index = i;
  }
  if (index >= infos.size()) {
    throw Unsupported(Diagnostic{{},
                                 fmt::format("there is no device '{}'", choice),
                                 fmt::format("a number below {} or one of '{}'", infos.size(), fmt::join(names, "', '")),
                                 nearest_name(choice, names)});
  }
  if (!infos[index].unfit.empty()) throw Unsupported(fmt::format("{} lacks {}", infos[index].name, infos[index].unfit));
  return index;
}

vk::raii::PhysicalDevice choose(const Instance& instance, std::string_view choice) {
  std::vector<vk::raii::PhysicalDevice> devices = instance.devices();
  std::vector<DeviceInfo> infos;
  infos.reserve(devices.size());
  for (const vk::raii::PhysicalDevice& physical : devices) infos.push_back(describe(physical));
  return std::move(devices[find_device(infos, choice)]);
}

/// A family that computes and keeps time; one that does nothing but compute where there is one.
std::uint32_t compute_family(const vk::raii::PhysicalDevice& physical, std::uint64_t& timestamp_mask) {
  const auto families = physical.getQueueFamilyProperties();
  std::optional<std::uint32_t> found;
  for (std::uint32_t i = 0; i < families.size(); ++i) {
    const vk::QueueFamilyProperties& family = families[i];
    if (!(family.queueFlags & vk::QueueFlagBits::eCompute) || family.timestampValidBits == 0) continue;
    const bool alone = !(family.queueFlags & vk::QueueFlagBits::eGraphics);
    if (found && !alone) continue;
    found = i;
    timestamp_mask = family.timestampValidBits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << family.timestampValidBits) - 1;
  }
  return found.value();
}

}  // namespace

DeviceImpl::DeviceImpl(std::string_view choice) : physical(choose(instance, choice)), info(describe(physical)) {
  limits = physical.getProperties().limits;
  timestamp_seconds = static_cast<double>(limits.timestampPeriod) * 1e-9;
  family = compute_family(physical, timestamp_mask);
  doubles = physical.getFeatures().shaderFloat64 != VK_FALSE;
  min_subgroup = max_subgroup = info.subgroup_size;
  const float priority = 1;
  const vk::DeviceQueueCreateInfo queue_info({}, family, 1, &priority);
  vk::PhysicalDeviceVulkan12Features features;
  features.bufferDeviceAddress = VK_TRUE;
  features.scalarBlockLayout = VK_TRUE;
  features.hostQueryReset = VK_TRUE;
  std::vector<const char*> extensions;
  vk::PhysicalDeviceSubgroupSizeControlFeaturesEXT sizes;
  for (const vk::ExtensionProperties& extension : physical.enumerateDeviceExtensionProperties()) {
    if (std::string_view(extension.extensionName.data()) != VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME) continue;
    const auto range =
        physical.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupSizeControlPropertiesEXT>()
            .get<vk::PhysicalDeviceSubgroupSizeControlPropertiesEXT>();
    min_subgroup = range.minSubgroupSize;
    max_subgroup = range.maxSubgroupSize;
    extensions.push_back(VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME);
    sizes.subgroupSizeControl = VK_TRUE;
    sizes.pNext = features.pNext;
    features.pNext = &sizes;
  }
  vk::PhysicalDeviceFeatures core_features;
  core_features.shaderFloat64 = doubles ? VK_TRUE : VK_FALSE;
  vk::DeviceCreateInfo create({}, queue_info, {}, extensions, &core_features);
  create.pNext = &features;
  checked("making the Vulkan device", [&] {
    device.emplace(physical, create);
    queue.emplace(*device, family, 0);
    pool.emplace(*device, vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eTransient, family));
    queries.emplace(*device, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, most_marks));
  });
}

void DeviceImpl::submit_and_wait(vk::CommandBuffer commands) {
  if (lost) throw Error(fmt::format("{} was lost before", info.name));
  const std::uint64_t most = time_out();
  try {
    vk::raii::Fence fence(*device, vk::FenceCreateInfo());
    queue->submit(vk::SubmitInfo({}, {}, commands), *fence);
    if (device->waitForFences(*fence, VK_TRUE, most) == vk::Result::eTimeout) {
      lost = true;
      static_cast<void>(fence.release());
      throw Error(
          fmt::format("{} did not finish within {} s (RAYSTUDY_DEVICE_TIMEOUT)", info.name, static_cast<double>(most) / 1e9));
    }
  } catch (const vk::DeviceLostError&) {
    lost = true;
    throw Error(fmt::format("{} was lost", info.name));
  }
  check_messages();
}

void DeviceImpl::check_messages() {
  const std::string messages = instance.take_messages();
  if (!messages.empty()) throw Error("Vulkan validation: " + messages);
}

std::uint32_t DeviceImpl::memory_type(std::uint32_t allowed, vk::MemoryPropertyFlags wanted) const {
  const vk::PhysicalDeviceMemoryProperties memory = physical.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
    if ((allowed >> i & 1U) != 0 && (memory.memoryTypes.at(i).propertyFlags & wanted) == wanted) return i;
  }
  throw Error(fmt::format("{} has no memory of the kind {}", info.name, vk::to_string(wanted)));
}

std::string device_of_environment() {
  const char* choice = std::getenv("RAYSTUDY_DEVICE");
  return choice != nullptr ? choice : "";
}

void check_device(std::string_view choice) { static_cast<void>(find_device(list_devices(), choice)); }

void choose_device(std::string choice) { chosen() = std::move(choice); }

Device::Device(std::string_view choice)
    : impl_(checked("opening the Vulkan device", [&] { return std::make_unique<DeviceImpl>(choice); })) {}

// A lost device may still be at work: waiting for it could take for ever, and what it works with (buffers, commands) stays.
Device::~Device() {
  if (impl_ && impl_->lost) static_cast<void>(impl_.release());
}

Device& Device::shared() {
  auto& device = shared_device();
  if (!device) device = std::make_unique<Device>(chosen());
  return *device;
}

const DeviceInfo* Device::shared_info() { return shared_device() ? &shared_device()->info() : nullptr; }

const DeviceInfo& Device::info() const { return impl_->info; }
std::size_t Device::bytes() const { return impl_->bytes; }
std::size_t Device::peak_bytes() const { return impl_->peak_bytes; }
void Device::reset_peak_bytes() { impl_->peak_bytes = impl_->bytes; }
std::uint32_t Device::max_groups() const { return impl_->limits.maxComputeWorkGroupCount[0]; }
std::uint32_t Device::shared_memory() const { return impl_->limits.maxComputeSharedMemorySize; }
bool Device::has_doubles() const { return impl_->doubles; }

const Kernel& Device::kernel(std::string_view name, const Constants& constants, std::uint32_t subgroup_size) {
  auto& kernel = impl_->kernels[{std::string(name), constants, subgroup_size}];
  if (!kernel) {
    kernel = checked(fmt::format("compiling the shader '{}'", name),
                     [&] { return std::make_unique<Kernel>(*impl_, name, constants, subgroup_size); });
    impl_->check_messages();
  }
  return *kernel;
}

}  // namespace raystudy::vulkan
