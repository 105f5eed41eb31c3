#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"
#include "harness/vulkan/commands.h"

namespace raystudy::gpu {

/// In what order a device recomputes the boxes of a tree. Both give those of Refitter (harness/accel/refit.h) bit for bit.
enum class DeviceRefitMethod : std::uint8_t {
  atomics,  ///< from the leaves up: of two siblings the later one goes on to their parent (Karras 2012, Sec. 4)
  levels    ///< a dispatch a level, from the deepest (Lauterbach 2010, Sec. 4.1.3, breadth first)
};

/// A tree on a device whose boxes can be recomputed for triangles that have moved.
class DeviceRefit {
 public:
  /// `triangles` are the scene's. Throws Error where the device's memory is too small, and where leaves or,
  /// with atomics, the tree are so large that an invocation would do more than `most_steps` loop iterations.
  DeviceRefit(vulkan::Device& device, const Bvh2& bvh, std::span<const Triangle> triangles, DeviceRefitMethod method);

  /// `vertices` are the scene's at the moment, three floats each.
  void record(vulkan::Commands& commands, const vulkan::Slice& vertices) const;

  /// In the places they have in Bvh2::nodes.
  [[nodiscard]] const vulkan::Slice& nodes() const { return nodes_; }
  [[nodiscard]] std::size_t bytes() const { return arena_.bytes(); }

  /// llvmpipe (Mesa 22.3) ends loops, silently, after 65535 iterations of all loops of a subgroup.
  static constexpr std::size_t most_steps = 65000;

 private:
  /// What the host finds out of a tree's form.
  struct Form;
  DeviceRefit(vulkan::Device& device, const Bvh2& bvh, std::span<const Triangle> triangles, DeviceRefitMethod method,
              const Form& form);

  DeviceRefitMethod method_;
  vulkan::Arena arena_;
  vulkan::Slice nodes_;
  vulkan::Slice corners_;                  ///< of Bvh2::triangles, in their order
  vulkan::Slice order_;                    ///< of atomics the leaves, of levels all nodes, level by level from the deepest
  vulkan::Slice parents_;                  ///< of atomics: for each pair the node that it is below
  vulkan::Slice arrivals_;                 ///< of atomics: of each pair, 0 between refits
  std::vector<std::uint32_t> level_ends_;  ///< in order_
  std::uint32_t group_;
  const vulkan::Kernel& kernel_;
};

}  // namespace raystudy::gpu
