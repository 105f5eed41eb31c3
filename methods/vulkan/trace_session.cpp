#include "methods/vulkan/trace_session.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "harness/base/unsupported.h"
#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {
namespace {

constexpr std::uint32_t rays_in_piece = 1U << 18U;
constexpr std::size_t spill_bytes = std::size_t{64} << 20U;
constexpr std::size_t entry_bytes = 8;
constexpr std::uint32_t long_rays_at_once = 4096;
constexpr std::size_t state_bytes = 40;

/// Of one ray, as trace.comp counts.
struct RayCounts {
  std::uint32_t inner_nodes;
  std::uint32_t leaves;
  std::uint32_t box_tests;
  std::uint32_t triangle_tests;
};

}  // namespace

struct GpuTraceSession::TracePush {
  std::uint64_t pairs;
  std::uint64_t triangles;
  std::uint64_t rays;
  std::uint64_t hits;
  std::uint64_t counts;
  std::uint64_t spill;
  std::uint64_t progress;
  std::uint64_t unfinished;
  std::uint64_t states;
  Vec3 lower;
  Vec3 upper;
  std::uint32_t root;
  std::uint32_t ray_count;
  std::uint32_t invocations;
  std::uint32_t resumed;
};

TraceShape trace_shape_of(const vulkan::Device& device) {
  // llvmpipe (Mesa 22.3) ends loops, silently, after 65535 iterations of all loops of a subgroup. On a GPU the limit keeps
  // dispatches short.
  if (device.info().type == "cpu") return {64, false, 64, false, 64, 65535 / device.info().subgroup_size - 64};
  return {128, false, 1024, true, 8, 1U << 18U};
}

GpuTraceSession::Buffers::Buffers(vulkan::Device& device, std::uint32_t ray_count, bool with_counts, std::size_t spill_bytes)
    : rays(ray_count),
      counting(with_counts),
      ray(device, rays * sizeof(Ray)),
      hit(device, rays * sizeof(Hit)),
      counts(device, counting ? rays * sizeof(RayCounts) : 0),
      spill(device, spill_bytes),
      progress(device, sizeof(Progress)),
      unfinished(device, rays * sizeof(std::uint32_t)) {}

GpuTraceSession::GpuTraceSession(vulkan::Device& device, const Bvh2& bvh, const Scene& scene, const TraceShape& shape)
    : device_(device), shape_(shape) {
  if (!device.has_doubles()) throw Unsupported(fmt::format("{} has no double precision (shaderFloat64)", device.info().name));
  device.reset_peak_bytes();
  if (!bvh.empty()) tree_.emplace(device, bvh, scene);
}

std::uint32_t GpuTraceSession::spilled_entries() const {
  return tree_->height() > shape_.stack_entries ? tree_->height() - shape_.stack_entries : 0;
}

std::uint32_t GpuTraceSession::most_stacks() const {
  if (spilled_entries() == 0) return rays_in_piece;
  const std::size_t groups = spill_bytes / (spilled_entries() * entry_bytes) / shape_.group;
  return static_cast<std::uint32_t>(std::clamp<std::size_t>(groups * shape_.group, shape_.group, rays_in_piece));
}

std::uint32_t GpuTraceSession::groups_of(std::uint32_t rays) const {
  const auto groups = static_cast<std::uint32_t>(groups_for(rays, shape_.group));
  return shape_.persistent ? std::min({groups, shape_.groups, most_stacks() / shape_.group}) : groups;
}

std::uint32_t GpuTraceSession::most_rays() const { return shape_.persistent ? rays_in_piece : most_stacks(); }

const GpuTraceSession::Buffers& GpuTraceSession::buffers_for(std::size_t rays, bool counting) {
  const auto n = static_cast<std::uint32_t>(std::min<std::size_t>(rays, most_rays()));
  if (!buffers_ || buffers_->rays < n || buffers_->counting != counting) {
    buffers_.reset();
    const std::size_t stacks = std::size_t{groups_of(n)} * shape_.group;
    buffers_ = std::make_unique<Buffers>(device_, n, counting, stacks * spilled_entries() * entry_bytes);
  }
  return *buffers_;
}

const vulkan::Kernel& GpuTraceSession::kernel(Query query, bool counting, bool long_rays) {
  const TraceShape& shape = shape_;
  return device_.kernel(
      "trace", {shape.group, query == Query::any_hit ? 1U : 0U, counting ? 1U : 0U, !long_rays && shape.persistent ? 1U : 0U,
                !long_rays && shape.shared_stack ? 1U : 0U, long_rays ? 0 : shape.stack_entries, shape.step_limit,
                long_rays ? 1U : 0U, long_rays || spilled_entries() > 0 ? 1U : 0U});
}

void GpuTraceSession::run_and_time(const vulkan::Kernel& kernel, const TracePush& push, std::uint32_t groups) {
  vulkan::Commands commands(device_);
  commands.mark("trace");
  commands.run(kernel, push, groups);
  times_.seconds = *times_.seconds + vulkan::total_seconds(commands.finish());
}

void GpuTraceSession::run(const Buffers& buffers, std::uint32_t rays, Query query) {
  const std::uint32_t groups = groups_of(rays);
  const TracePush push{.pairs = tree_->pairs().address(),
                       .triangles = tree_->triangles().address(),
                       .rays = buffers.ray.address(),
                       .hits = buffers.hit.address(),
                       .counts = buffers.counts.address(),
                       .spill = buffers.spill.address(),
                       .progress = buffers.progress.address(),
                       .unfinished = buffers.unfinished.address(),
                       .states = 0,
                       .lower = tree_->bounds().lower,
                       .upper = tree_->bounds().upper,
                       .root = tree_->root(),
                       .ray_count = rays,
                       .invocations = groups * shape_.group,
                       .resumed = 0};
  Progress progress{0, 0};
  vulkan::upload(device_, buffers.progress.all(), std::span<const Progress>(&progress, 1));
  do {
    run_and_time(kernel(query, buffers.counting, false), push, groups);
    vulkan::download(device_, buffers.progress.all(), std::as_writable_bytes(std::span(&progress, 1)));
  } while (shape_.persistent && progress.next_ray < rays);
  if (progress.unfinished > 0) run_long_rays(push, buffers.counting, progress.unfinished, query);
}

void GpuTraceSession::run_long_rays(const TracePush& of_piece, bool counting, std::uint32_t rays, Query query) {
  const std::size_t stack_bytes = std::max<std::size_t>(tree_->height(), 1) * entry_bytes;
  const auto most = static_cast<std::uint32_t>(std::clamp<std::size_t>(spill_bytes / stack_bytes, 1, long_rays_at_once));
  const std::uint32_t invocations = static_cast<std::uint32_t>(groups_for(std::min(rays, most), shape_.group)) * shape_.group;
  const vulkan::Buffer spill(device_, invocations * stack_bytes);
  const vulkan::Buffer states(device_, invocations * state_bytes);
  const vulkan::Buffer progress_buffer(device_, sizeof(Progress));
  TracePush push = of_piece;
  push.spill = spill.address();
  push.states = states.address();
  push.progress = progress_buffer.address();
  push.invocations = invocations;
  for (std::uint32_t begin = 0; begin < rays; begin += invocations) {
    push.unfinished = of_piece.unfinished + begin * sizeof(std::uint32_t);
    push.ray_count = std::min(invocations, rays - begin);
    push.resumed = 0;
    Progress progress{};
    do {
      progress = {};
      vulkan::upload(device_, progress_buffer.all(), std::span<const Progress>(&progress, 1));
      run_and_time(kernel(query, counting, true), push, invocations / shape_.group);
      vulkan::download(device_, progress_buffer.all(), std::as_writable_bytes(std::span(&progress, 1)));
      push.resumed = 1;
    } while (progress.unfinished > 0);
  }
}

template <class Done>
void GpuTraceSession::trace_pieces(std::span<const Ray> rays, Query query, bool counting, const Done& done) {
  times_ = {};
  times_.seconds = 0;
  const Buffers& buffers = buffers_for(rays.size(), counting);
  for (std::size_t begin = 0; begin < rays.size(); begin += buffers.rays) {
    const std::size_t count = std::min<std::size_t>(buffers.rays, rays.size() - begin);
    times_.upload += vulkan::upload(device_, buffers.ray.all(), rays.subspan(begin, count));
    run(buffers, static_cast<std::uint32_t>(count), query);
    done(buffers, begin, count);
  }
  times_.parts = {{"trace", *times_.seconds}};
  times_.peak_bytes = device_.peak_bytes();
}

void GpuTraceSession::trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
  if (!tree_) {
    std::fill(hits.begin(), hits.end(), Hit{});
    times_ = {};
    times_.seconds = 0;
    return;
  }
  trace_pieces(rays, query, false, [&](const Buffers& buffers, std::size_t begin, std::size_t count) {
    times_.download += vulkan::download(device_, buffers.hit.all(), std::as_writable_bytes(hits.subspan(begin, count)));
  });
}

TraceCounts GpuTraceSession::count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) {
  if (!steps.empty() && steps.size() != rays.size()) throw std::logic_error("as many step counts as rays are needed, or none");
  TraceCounts total;
  if (!tree_) {
    std::fill(steps.begin(), steps.end(), 0);
    return total;
  }
  std::vector<RayCounts> counts;
  trace_pieces(rays, query, true, [&](const Buffers& buffers, std::size_t begin, std::size_t count) {
    counts.resize(count);
    vulkan::download(device_, buffers.counts.all(), std::as_writable_bytes(std::span(counts)));
    for (std::size_t i = 0; i < count; ++i) {
      total.inner_nodes += counts[i].inner_nodes;
      total.leaves += counts[i].leaves;
      total.box_tests += counts[i].box_tests;
      total.triangle_tests += counts[i].triangle_tests;
      if (!steps.empty()) steps[begin + i] = counts[i].inner_nodes + counts[i].leaves;
    }
  });
  return total;
}

}  // namespace raystudy::gpu
