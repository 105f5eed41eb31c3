#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "harness/vulkan/buffer.h"
#include "harness/vulkan/device.h"

namespace raystudy::vulkan {

/// Seconds on the device between two marks.
struct PartTime {
  std::string part;
  double seconds = 0;
};

/// Commands being recorded, then run once. Commands see what those before the last barrier() wrote.
class Commands {
 public:
  explicit Commands(Device& device);
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  /// Runs `groups` workgroups. `push`: the shader's push constants, at most 128 bytes. More groups than fit along x go on along
  /// y: shaders count with group_index() of common.glsl, and must mind that the last row may be longer than needed.
  template <class Push>
  void run(const Kernel& kernel, const Push& push, std::uint64_t groups) {
    static_assert(std::is_trivially_copyable_v<Push> && sizeof(Push) <= 128);
    run_bytes(kernel, std::as_bytes(std::span(&push, 1)), groups);
  }
  /// The same with the three numbers of groups read from `groups` (12 bytes) when the command runs.
  template <class Push>
  void run_indirect(const Kernel& kernel, const Push& push, const Slice& groups) {
    static_assert(std::is_trivially_copyable_v<Push> && sizeof(Push) <= 128);
    run_indirect_bytes(kernel, std::as_bytes(std::span(&push, 1)), groups);
  }
  void fill(const Slice& to, std::uint32_t value);
  void copy(const Slice& from, const Slice& to);
  /// Everything after sees what everything before wrote, indirect numbers of groups included.
  void barrier();
  /// What comes from here to the next mark, or to the end, is timed as `part`; a part marked again adds to it. Without marks
  /// nothing is timed.
  void mark(std::string_view part);

  /// Runs them and waits; the parts in the order of their first marks. Throws Error where the device is lost, does not finish in
  /// time or the validation layer complains. Nothing can be recorded afterwards.
  std::vector<PartTime> finish();

 private:
  void run_bytes(const Kernel& kernel, std::span<const std::byte> push, std::uint64_t groups);
  void run_indirect_bytes(const Kernel& kernel, std::span<const std::byte> push, const Slice& groups);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The sum over parts.
[[nodiscard]] double total_seconds(std::span<const PartTime> parts);

}  // namespace raystudy::vulkan
