#include <fmt/format.h>

#include "harness/base/unsupported.h"
#include "harness/vulkan/impl.h"
#include "harness/vulkan/shader.h"

namespace raystudy::vulkan {
namespace {

vk::raii::PipelineLayout make_layout(const vk::raii::Device& device) {
  const vk::PushConstantRange range(vk::ShaderStageFlagBits::eCompute, 0, push_bytes);
  return {device, vk::PipelineLayoutCreateInfo({}, {}, range)};
}

vk::raii::Pipeline make_pipeline(const DeviceImpl& device, vk::PipelineLayout layout, std::string_view name,
                                 const Constants& constants, std::uint32_t subgroup_size) {
  if (subgroup_size != 0 && subgroup_size != device.info.subgroup_size &&
      (subgroup_size < device.min_subgroup || subgroup_size > device.max_subgroup)) {
    throw Unsupported(fmt::format("{} has subgroups of {} to {} lanes, not of {}", device.info.name, device.min_subgroup,
                                  device.max_subgroup, subgroup_size));
  }
  const auto code = shader_code(name);
  const vk::raii::ShaderModule module(*device.device, vk::ShaderModuleCreateInfo({}, code.size_bytes(), code.data()));
  std::vector<vk::SpecializationMapEntry> entries;
  for (std::uint32_t i = 0; i < constants.size(); ++i) {
    entries.emplace_back(i, i * sizeof(std::uint32_t), sizeof(std::uint32_t));
  }
  const vk::SpecializationInfo specialization(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                              constants.size() * sizeof(std::uint32_t), constants.data());
  vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main", &specialization);
  vk::PipelineShaderStageRequiredSubgroupSizeCreateInfoEXT required;
  if (subgroup_size != 0 && device.min_subgroup != device.max_subgroup) {
    required.requiredSubgroupSize = subgroup_size;
    stage.pNext = &required;
  }
  return {*device.device, nullptr, vk::ComputePipelineCreateInfo({}, stage, layout)};
}

}  // namespace

Kernel::Kernel(DeviceImpl& device, std::string_view name, const Constants& constants, std::uint32_t subgroup_size)
    : layout_(make_layout(*device.device)), pipeline_(make_pipeline(device, *layout_, name, constants, subgroup_size)) {}

}  // namespace raystudy::vulkan
