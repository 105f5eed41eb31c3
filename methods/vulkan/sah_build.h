#pragma once

#include <algorithm>
#include <cstdint>

#include "harness/accel/bvh2.h"
#include "harness/method/device_times.h"
#include "harness/vulkan/commands.h"
#include "methods/topdown/top_down.h"
#include "methods/vulkan/device_scene.h"
#include "methods/vulkan/prefix_sum.h"

namespace raystudy::gpu {

struct SahParams {
  topdown::LeafPolicy leaves;
  std::uint32_t samples;  ///< candidates an axis
};

struct SahKernels {
  SahKernels(vulkan::Device& device, const SahParams& params);

  std::uint32_t group;  ///< of those that are not a workgroup a node
  const vulkan::Kernel& bounds;
  const vulkan::Kernel& begin;
  const vulkan::Kernel& split;
  const vulkan::Kernel& reorder;
  const vulkan::Kernel& flags;
  const vulkan::Kernel& compact;
};

/// Builds a tree on a device level by level, by the surface area heuristic over samples (Lauterbach 2010, Sec. 5.2): a queue of
/// nodes to be split, one workgroup a split, and a compaction of their children into the queue of the next level.
class SahBuild {
 public:
  /// Compiles the kernels and takes the memory. The scene has one triangle at least.
  SahBuild(vulkan::Device& device, const DeviceScene& scene, const SahParams& params);

  void run();
  /// "Rest", "SAH split", "Reorder" and "Compaction".
  [[nodiscard]] const std::vector<vulkan::PartTime>& parts() const { return parts_; }
  [[nodiscard]] const std::vector<DeviceTimes::Level>& levels() const { return levels_; }
  /// Fetches the tree. The device's has a slot for every pair of children that single triangles would need, in the order in which
  /// the triangles of either lie; those that larger leaves leave unused are dropped. Returns seconds by the wall clock.
  double download(Bvh2& bvh) const;

 private:
  struct Waiting {
    std::uint32_t large;  ///< nodes to be split on the next level
    std::uint32_t small;  ///< of the small-split kernel, since the beginning
    double seconds;
  };

  void record_begin(vulkan::Commands& commands);
  void record_split(vulkan::Commands& commands, std::uint32_t active);
  void record_reorder(vulkan::Commands& commands, std::uint32_t active);
  void record_compaction(vulkan::Commands& commands, std::uint32_t children);
  Waiting finish(vulkan::Commands& commands);
  [[nodiscard]] std::uint32_t scratch_words() const { return std::max(count_, children_count_ + 1); }

  vulkan::Device& device_;
  const DeviceScene& scene_;
  SahParams params_;
  std::uint32_t count_;
  std::uint32_t small_ = 1;
  std::uint32_t capacity_;  ///< of the queue
  std::uint32_t children_count_;
  PrefixSum sum_;
  SahKernels kernels_;
  vulkan::Arena arena_;
  vulkan::Buffer readback_;
  vulkan::Slice boxes_;
  vulkan::Slice bounds_;
  vulkan::Slice indices_;
  vulkan::Slice nodes_;
  vulkan::Slice queue_;
  vulkan::Slice children_;
  vulkan::Slice scratch_;  ///< triangles that go right; then flags and their prefix sums
  vulkan::Slice sum_room_;
  vulkan::Slice small_count_;
  std::vector<vulkan::PartTime> parts_;
  std::vector<DeviceTimes::Level> levels_;
};

}  // namespace raystudy::gpu
