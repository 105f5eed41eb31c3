#pragma once

#include <cstdint>
#include <vector>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/device_scene.h"
#include "methods/vulkan/device_shape.h"
#include "methods/vulkan/radix_sort.h"

namespace raystudy::gpu {

/// The triangles of a scene in the order of the Morton codes of their boxes' centers, on a device: the order that
/// methods/lbvh/README.md defines.
class MortonOrder {
 public:
  /// `bits`: 30, 60 or 63. The scene has one triangle at least.
  MortonOrder(vulkan::Device& device, const DeviceScene& scene, std::uint32_t bits)
      : MortonOrder(device, scene, bits, shape_of(device)) {}
  MortonOrder(vulkan::Device& device, const DeviceScene& scene, std::uint32_t bits, const DeviceShape& shape);

  /// Parts "bounds", "morton" and "sort".
  [[nodiscard]] std::vector<vulkan::PartTime> build();

  /// That of the work on the order, and on what is built upon it.
  [[nodiscard]] const DeviceShape& shape() const { return shape_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }
  [[nodiscard]] bool two_words() const { return bits_ > 32; }
  [[nodiscard]] const vulkan::Slice& boxes() const { return boxes_; }  ///< of the triangles in the scene's order
  [[nodiscard]] const vulkan::Slice& low() const { return sorted_->low; }
  [[nodiscard]] const vulkan::Slice& high() const { return sorted_->high; }
  [[nodiscard]] const vulkan::Slice& order() const { return sorted_->values; }
  /// Two rooms of count + 1 words each that nothing uses after the sort.
  [[nodiscard]] const vulkan::Slice& first_room() const { return spare_->low; }
  [[nodiscard]] const vulkan::Slice& second_room() const { return spare_->values; }

 private:
  vulkan::Device& device_;
  const DeviceScene& scene_;
  DeviceShape shape_;
  std::uint32_t bits_;
  std::uint32_t count_;
  RadixSort sort_;
  vulkan::Arena arena_;
  vulkan::Slice boxes_;
  vulkan::Slice bounds_;
  vulkan::Slice grid_;
  vulkan::Slice sort_room_;
  SortItems items_;
  SortItems other_;
  const SortItems* sorted_ = nullptr;
  const SortItems* spare_ = nullptr;
};

}  // namespace raystudy::gpu
