#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy::vulkan {

/// A Vulkan device of this machine as its driver describes it.
struct DeviceInfo {
  std::string name;
  std::string driver;  ///< the driver's name and version, as it tells them
  std::string type;    ///< discrete, integrated, virtual, cpu or other
  std::uint32_t subgroup_size = 0;
  std::uint64_t memory = 0;  ///< bytes of its largest heap of its own
  std::string unfit{};       ///< what Raystudy needs and the device lacks; empty where it will do
};

/// Every device, in the order of the drivers; none where there is no Vulkan loader or driver. Creates no device.
[[nodiscard]] std::vector<DeviceInfo> list_devices();

/// Says which device Device::shared() will be: its name, its number in list_devices(), or empty for the best (discrete before
/// integrated before virtual before cpu). For the whole process; before the first use of a device. Without it, what
/// RAYSTUDY_DEVICE says.
void choose_device(std::string choice);
/// RAYSTUDY_DEVICE; empty where it is not set.
[[nodiscard]] std::string device_of_environment();
/// Throws what Device(choice) would.
void check_device(std::string_view choice);

class Kernel;
struct DeviceImpl;

/// Values for a shader's specialization constants: constant_id i gets the i-th.
using Constants = std::vector<std::uint32_t>;

/// A device with one queue. Not for several threads at once. Everything that waits has a time-out (RAYSTUDY_DEVICE_TIMEOUT
/// seconds, 30 where not set), after which the device counts as lost.
///
/// With RAYSTUDY_VULKAN_VALIDATION=1 the Khronos validation layer watches, synchronization included, and its first message is
/// an Error of the call that waits next.
class Device {
 public:
  /// Throws Unsupported where there is no such device, or none, or it lacks what is needed.
  explicit Device(std::string_view choice);
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// The process's device, made when first asked for. After a fork the child must not use what its parent made.
  static Device& shared();
  /// What shared() is, once it has been made; nullptr before.
  static const DeviceInfo* shared_info();

  [[nodiscard]] const DeviceInfo& info() const;
  /// Of the SPIR-V code `name` (see shader.h) with constants; compiled once, then kept. `subgroup_size` 0: as the device likes.
  const Kernel& kernel(std::string_view name, const Constants& constants = {}, std::uint32_t subgroup_size = 0);
  /// Bytes of all buffers that now exist, and the most since reset_peak_bytes(). Staging memory is not counted.
  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t peak_bytes() const;
  void reset_peak_bytes();
  /// Workgroups along x that a dispatch may have.
  [[nodiscard]] std::uint32_t max_groups() const;
  [[nodiscard]] std::uint32_t shared_memory() const;
  /// Whether kernels may use double precision (shaderFloat64), which is enabled wherever it is offered.
  [[nodiscard]] bool has_doubles() const;

  [[nodiscard]] DeviceImpl& impl() { return *impl_; }

 private:
  std::unique_ptr<DeviceImpl> impl_;
};

}  // namespace raystudy::vulkan
