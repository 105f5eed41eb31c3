#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "harness/vulkan/device.h"

namespace raystudy::vulkan {

/// A piece of a Buffer. Kernels get `address`.
struct Slice {
  const class Buffer* buffer = nullptr;
  std::size_t offset = 0;
  std::size_t bytes = 0;
  [[nodiscard]] std::uint64_t address() const;
  /// `size` bytes from `begin` on.
  [[nodiscard]] Slice part(std::size_t begin, std::size_t size) const { return {buffer, offset + begin, size}; }
};

/// Memory of a device, reached by address (no descriptors), so that no limit of a storage buffer's range applies.
class Buffer {
 public:
  enum class Kind : unsigned char { device, staging };

  /// Throws Error, with what was asked for and what the device has, where the memory is not to be had.
  Buffer(Device& device, std::size_t bytes, Kind kind = Kind::device);
  ~Buffer();
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  [[nodiscard]] std::uint64_t address() const;
  [[nodiscard]] std::size_t bytes() const;
  /// Where the processor sees a staging buffer.
  [[nodiscard]] std::byte* mapped() const;
  [[nodiscard]] Slice all() const { return {this, 0, bytes()}; }

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Cuts one buffer into slices, one after another, so that a build asks the driver for memory once.
class Arena {
 public:
  static constexpr std::size_t alignment = 256;

  /// Bytes that slices of these sizes take.
  static std::size_t bytes_for(std::initializer_list<std::size_t> sizes);

  Arena(Device& device, std::size_t bytes) : buffer_(device, bytes) {}
  /// Throws std::logic_error where nothing is left.
  Slice take(std::size_t bytes);
  [[nodiscard]] std::size_t bytes() const { return buffer_.bytes(); }

 private:
  Buffer buffer_;
  std::size_t used_ = 0;
};

/// Copies to and from a device, through staging memory, in pieces. Waits until it is done; returns seconds by the clock on the
/// wall, for upload and download are shown apart from what runs on the device.
double upload(Device& device, const Slice& to, std::span<const std::byte> from);
double download(Device& device, const Slice& from, std::span<std::byte> to);

template <class T>
double upload(Device& device, const Slice& to, std::span<const T> from) {
  static_assert(std::is_trivially_copyable_v<T>);
  return upload(device, to, std::as_bytes(from));
}

}  // namespace raystudy::vulkan
