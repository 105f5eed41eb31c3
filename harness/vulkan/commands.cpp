#include "harness/vulkan/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "harness/vulkan/buffer_impl.h"
#include "harness/vulkan/impl.h"

namespace raystudy::vulkan {

struct Commands::Impl {
  explicit Impl(DeviceImpl& d) : device(d) {
    vk::raii::CommandBuffers made(*d.device, vk::CommandBufferAllocateInfo(**d.pool, vk::CommandBufferLevel::ePrimary, 1));
    buffer.emplace(std::move(made.front()));
    buffer->begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
  }

  void bind(const Kernel& kernel, std::span<const std::byte> push) {
    buffer->bindPipeline(vk::PipelineBindPoint::eCompute, kernel.pipeline());
    buffer->pushConstants<std::byte>(kernel.layout(), vk::ShaderStageFlagBits::eCompute, 0,
                                     vk::ArrayProxy<const std::byte>(static_cast<std::uint32_t>(push.size()), push.data()));
  }

  void stamp() {
    buffer->writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, **device.queries, stamps);
    ++stamps;
  }

  DeviceImpl& device;
  std::optional<vk::raii::CommandBuffer> buffer;
  std::vector<std::string> marks;  ///< of each timestamp but the last
  std::uint32_t stamps = 0;
};

Commands::Commands(Device& device)
    : impl_(checked("recording commands", [&] { return std::make_unique<Impl>(device.impl()); })) {}

Commands::~Commands() {
  if (impl_ && impl_->device.lost) static_cast<void>(impl_.release());
}

void Commands::run_bytes(const Kernel& kernel, std::span<const std::byte> push, std::uint64_t groups) {
  if (groups == 0) return;
  const std::uint64_t most = impl_->device.limits.maxComputeWorkGroupCount[0];
  const std::uint64_t rows = (groups + most - 1) / most;
  if (rows > impl_->device.limits.maxComputeWorkGroupCount[1]) {
    throw Error(fmt::format("{} workgroups are more than {} runs", groups, impl_->device.info.name));
  }
  const std::uint64_t along_x = (groups + rows - 1) / rows;
  impl_->bind(kernel, push);
  impl_->buffer->dispatch(static_cast<std::uint32_t>(along_x), static_cast<std::uint32_t>(rows), 1);
}

void Commands::run_indirect_bytes(const Kernel& kernel, std::span<const std::byte> push, const Slice& groups) {
  impl_->bind(kernel, push);
  impl_->buffer->dispatchIndirect(**groups.buffer->impl().buffer, groups.offset);
}

void Commands::fill(const Slice& to, std::uint32_t value) {
  impl_->buffer->fillBuffer(**to.buffer->impl().buffer, to.offset, (to.bytes + 3) / 4 * 4, value);
}

void Commands::copy(const Slice& from, const Slice& to) {
  if (from.bytes > to.bytes) throw std::logic_error("more is copied than there is room for");
  if (from.bytes == 0) return;
  impl_->buffer->copyBuffer(**from.buffer->impl().buffer, **to.buffer->impl().buffer,
                            vk::BufferCopy(from.offset, to.offset, from.bytes));
}

void Commands::barrier() {
  using Access = vk::AccessFlagBits;
  using Stage = vk::PipelineStageFlagBits;
  const vk::MemoryBarrier all(Access::eShaderWrite | Access::eTransferWrite, Access::eShaderRead | Access::eShaderWrite |
                                                                                 Access::eTransferRead | Access::eTransferWrite |
                                                                                 Access::eIndirectCommandRead);
  impl_->buffer->pipelineBarrier(Stage::eComputeShader | Stage::eTransfer,
                                 Stage::eComputeShader | Stage::eTransfer | Stage::eDrawIndirect, {}, all, {}, {});
}

void Commands::mark(std::string_view part) {
  if (impl_->stamps + 2 > most_marks) throw std::logic_error("too many marks in one recording");
  impl_->marks.emplace_back(part);
  impl_->stamp();
}

std::vector<PartTime> Commands::finish() {
  DeviceImpl& device = impl_->device;
  if (!impl_->marks.empty()) impl_->stamp();
  // What was written is to be read by the processor.
  impl_->buffer->pipelineBarrier(
      vk::PipelineStageFlagBits::eComputeShader | vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eHost, {},
      vk::MemoryBarrier(vk::AccessFlagBits::eShaderWrite | vk::AccessFlagBits::eTransferWrite, vk::AccessFlagBits::eHostRead), {},
      {});
  impl_->buffer->end();
  device.queries->reset(0, std::max(impl_->stamps, 1U));
  device.submit_and_wait(**impl_->buffer);
  std::vector<PartTime> parts;
  if (impl_->marks.empty()) return parts;
  const auto [result, ticks] =
      device.queries->getResults<std::uint64_t>(0, impl_->stamps, impl_->stamps * sizeof(std::uint64_t), sizeof(std::uint64_t),
                                                vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
  if (result != vk::Result::eSuccess) throw Error("the device's timestamps cannot be read: " + vk::to_string(result));
  for (std::size_t i = 0; i < impl_->marks.size(); ++i) {
    const auto found = std::find_if(parts.begin(), parts.end(), [&](const PartTime& p) { return p.part == impl_->marks[i]; });
    PartTime& part = found != parts.end() ? *found : parts.emplace_back(PartTime{impl_->marks[i], 0});
    part.seconds += static_cast<double>((ticks[i + 1] - ticks[i]) & device.timestamp_mask) * device.timestamp_seconds;
  }
  return parts;
}

double total_seconds(std::span<const PartTime> parts) {
  return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const PartTime& p) { return sum + p.seconds; });
}

}  // namespace raystudy::vulkan
