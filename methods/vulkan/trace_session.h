#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "harness/method/method.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/traversal_tree.h"

namespace raystudy::gpu {

/// How rays are given to invocations, and where their stacks are.
struct TraceShape {
  std::uint32_t group;          ///< invocations of a workgroup
  bool persistent;              ///< invocations fetch rays until there are none (Aila and Laine 2009), instead of one each
  std::uint32_t groups;         ///< of persistent invocations
  bool shared_stack;            ///< the entries at hand are in shared memory, instead of an invocation's own
  std::uint32_t stack_entries;  ///< at hand; what is deeper is in the device's memory
  std::uint32_t step_limit;     ///< loop iterations of an invocation in one dispatch
};

/// The shape that is fast on a device.
[[nodiscard]] TraceShape trace_shape_of(const vulkan::Device& device);

/// Traces rays on a device, in pieces of which rays, hits and stacks fit its memory.
class GpuTraceSession final : public TraceSession {
 public:
  /// Throws Unsupported where the device has no double precision.
  GpuTraceSession(vulkan::Device& device, const Bvh2& bvh, const Scene& scene, const TraceShape& shape);

  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override;
  [[nodiscard]] const DeviceTimes* device_times() const override { return &times_; }
  [[nodiscard]] bool counts() const override { return true; }
  TraceCounts count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) override;

 private:
  /// What a piece of rays needs on the device.
  struct Buffers {
    Buffers(vulkan::Device& device, std::uint32_t ray_count, bool with_counts, std::size_t spill_bytes);

    std::uint32_t rays;
    bool counting;
    vulkan::Buffer ray;
    vulkan::Buffer hit;
    vulkan::Buffer counts;
    vulkan::Buffer spill;
    vulkan::Buffer progress;
    vulkan::Buffer unfinished;
  };
  struct TracePush;
  /// As trace.comp counts: the next ray to be fetched, and how many rays took too many steps.
  struct Progress {
    std::uint32_t next_ray;
    std::uint32_t unfinished;
  };

  /// Entries of an invocation's stack that are not at hand.
  [[nodiscard]] std::uint32_t spilled_entries() const;
  /// Invocations whose stacks have room, one workgroup at least.
  [[nodiscard]] std::uint32_t most_stacks() const;
  [[nodiscard]] std::uint32_t groups_of(std::uint32_t rays) const;
  /// Of a piece.
  [[nodiscard]] std::uint32_t most_rays() const;
  const Buffers& buffers_for(std::size_t rays, bool counting);
  [[nodiscard]] const vulkan::Kernel& kernel(Query query, bool counting, bool long_rays);
  /// Traces the rays of a piece.
  void run(const Buffers& buffers, std::uint32_t rays, Query query);
  /// Traces those of them that took too many steps, as many steps at a time.
  void run_long_rays(const TracePush& of_piece, bool counting, std::uint32_t rays, Query query);
  void run_and_time(const vulkan::Kernel& kernel, const TracePush& push, std::uint32_t groups);
  /// Calls done(buffers, begin, count) for each piece when it has been traced.
  template <class Done>
  void trace_pieces(std::span<const Ray> rays, Query query, bool counting, const Done& done);

  vulkan::Device& device_;
  TraceShape shape_;
  std::optional<TraversalTree> tree_;  ///< none where the tree is empty
  std::unique_ptr<Buffers> buffers_;
  DeviceTimes times_;
};

}  // namespace raystudy::gpu
