#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/method/device_times.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/device_scene.h"
#include "methods/vulkan/prefix_sum.h"
#include "methods/vulkan/sah_hybrid.h"
#include "methods/vulkan/sah_large.h"
#include "methods/vulkan/sah_memory.h"

namespace raystudy::gpu {

struct SahKernels {
  SahKernels(vulkan::Device& device, const SahParams& params);

  std::uint32_t group;  ///< of those that are not a workgroup a node
  const vulkan::Kernel& bounds;
  const vulkan::Kernel& begin;
  const vulkan::Kernel& split;
  const vulkan::Kernel& reorder;
  const vulkan::Kernel& flags;
  const vulkan::Kernel& compact;
  const vulkan::Kernel& small;
};

/// Builds a tree on a device level by level, by the surface area heuristic over samples (Lauterbach 2010, Sec. 5.2): a queue of
/// nodes to be split, one workgroup a split, and a compaction of their children into the queue of the next level.
class SahBuild {
 public:
  /// Compiles the kernels and takes the memory. The scene has one triangle at least.
  SahBuild(vulkan::Device& device, const DeviceScene& scene, const SahParams& params);

  void run();
  /// "Rest", "LBVH", "SAH split", "Reorder", "Compaction" and "Small splits".
  [[nodiscard]] const std::vector<vulkan::PartTime>& parts() const { return parts_; }
  [[nodiscard]] const std::vector<DeviceTimes::Level>& levels() const { return levels_; }
  /// Fetches the tree. The device's has a slot for every pair of children that single triangles would need, in the order in which
  /// the triangles of either lie; those that larger leaves leave unused are dropped. Returns seconds by the wall clock.
  double download(Bvh2& bvh) const;

 private:
  void begin();
  /// Sends nodes to where they will be split.
  void add(std::span<const SahNode> nodes);
  /// Splits all nodes that wait, and leaves their children waiting.
  void run_level();
  void run_small();
  void record_split(vulkan::Commands& commands);
  void record_reorder(vulkan::Commands& commands);
  void record_compaction(vulkan::Commands& commands);
  /// Runs them; returns seconds.
  double finish(vulkan::Commands& commands);

  vulkan::Device& device_;
  const DeviceScene& scene_;
  SahParams params_;
  std::uint32_t count_;
  std::uint32_t small_;           ///< most triangles of a node for the small-split kernel
  std::uint32_t capacity_;        ///< of the queue
  std::uint32_t children_count_;  ///< most children of a level
  PrefixSum sum_;
  SahKernels kernels_;
  vulkan::Arena arena_;
  vulkan::Buffer readback_;
  vulkan::Slice bounds_;
  vulkan::Slice queue_;  ///< from the front nodes to be split, from the end on small ones
  vulkan::Slice children_;
  vulkan::Slice small_count_;
  SahMemory memory_;
  std::optional<LargeSplits> large_splits_;
  std::optional<LbvhLevels> lbvh_levels_;

  std::uint32_t active_ = 0;            ///< nodes in the queue
  std::uint32_t small_active_ = 0;      ///< small ones
  std::vector<SahNode> large_;          ///< nodes for several workgroups
  std::vector<std::uint32_t> joining_;  ///< nodes that are not in the queue yet
  std::vector<vulkan::PartTime> parts_;
  std::vector<DeviceTimes::Level> levels_;
};

}  // namespace raystudy::gpu
