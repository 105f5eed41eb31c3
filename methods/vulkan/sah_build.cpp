#include "methods/vulkan/sah_build.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "methods/vulkan/download_tree.h"

namespace raystudy::gpu {
namespace {

constexpr std::size_t word = sizeof(std::uint32_t);

struct BoundsPush {
  std::uint64_t vertices;
  std::uint64_t triangles;
  std::uint64_t boxes;
  std::uint64_t bounds;
  std::uint32_t count;
};
struct BeginPush {
  std::uint64_t bounds;
  std::uint64_t indices;
  std::uint64_t nodes;
  std::uint64_t children;
  std::uint32_t count;
  std::uint32_t small;
};
struct SplitPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t nodes;
  std::uint64_t from;
  std::uint64_t decisions;
  std::uint32_t count;
  std::uint32_t max_leaf;
  float traversal;
  float intersection;
  float spacing;
};
struct ReorderPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t scratch;
  std::uint64_t nodes;
  std::uint64_t from;
  std::uint64_t to;
  std::uint32_t count;
  std::uint32_t small;
};
struct FlagsPush {
  std::uint64_t children;
  std::uint64_t flags;
  std::uint64_t queue;
  std::uint64_t small_count;
  std::uint32_t count;
  std::uint32_t capacity;
};
struct CompactPush {
  std::uint64_t children;
  std::uint64_t places;
  std::uint64_t to;
  std::uint32_t count;
};

/// A workgroup that splits a node. On a GPU one invocation a candidate, as in the thesis, in as many as every device has; on a
/// processor, where reading a triangle's box is dear, invocations of several candidates each.
const vulkan::Kernel& split_kernel(vulkan::Device& device, std::uint32_t samples) {
  const std::uint32_t candidates = 3 * samples;
  const std::uint32_t own = device.info().type == "cpu" ? 8 : (candidates + 191) / 192;
  return device.kernel("sah_split", {(candidates + own - 1) / own, samples, own});
}

std::uint32_t reorder_group(const vulkan::Device& device) { return device.info().type == "cpu" ? 8 : 128; }

std::uint64_t groups_of(std::uint64_t n, std::uint32_t group) { return (n + group - 1) / group; }

/// The most nodes of more than `small` triangles on a level.
std::uint32_t most_active(std::uint32_t n, std::uint32_t small) { return std::max(n / (small + 1), 1U); }

/// Drops the pairs of nodes that are all zeros, and keeps the order of the others.
void drop_unused(AlignedVector<Bvh2Node>& nodes) {
  const auto used = [&](std::size_t i) { return i == 0 || nodes[i].count > 0 || nodes[i].first > 0; };
  std::vector<std::uint32_t> places(nodes.size() / 2);
  std::uint32_t end = 0;
  for (std::size_t i = 0; i < nodes.size(); i += 2) {
    places[i / 2] = end;
    if (used(i)) end += 2;
  }
  for (std::size_t i = 0; i < nodes.size(); i += 2) {
    if (!used(i)) continue;
    for (std::size_t side = 0; side < 2; ++side) {
      Bvh2Node node = nodes[i + side];
      if (!node.is_leaf()) node.first = places[node.first / 2];
      nodes[places[i / 2] + side] = node;
    }
  }
  nodes.resize(end);
}

}  // namespace

SahKernels::SahKernels(vulkan::Device& device, const SahParams& params)
    : group(shape_of(device).group),
      bounds(device.kernel("bounds", {group})),
      begin(device.kernel("sah_begin", {group})),
      split(split_kernel(device, params.samples)),
      reorder(device.kernel("sah_reorder", {reorder_group(device)})),
      flags(device.kernel("sah_flags", {group})),
      compact(device.kernel("sah_compact", {group})) {}

SahBuild::SahBuild(vulkan::Device& device, const DeviceScene& scene, const SahParams& params)
    : device_(device),
      scene_(scene),
      params_(params),
      count_(scene.triangle_count()),
      capacity_(std::max(count_ / 2, 1U)),
      children_count_(2 * most_active(count_, small_)),
      sum_(device),
      kernels_(device, params),
      arena_(device, vulkan::Arena::bytes_for({count_ * sizeof(Box), 6 * word, count_ * word, 2 * count_ * sizeof(Bvh2Node),
                                               capacity_ * word, children_count_ * word, scratch_words() * word,
                                               sum_.room_for(children_count_), word})),
      readback_(device, 2 * word, vulkan::Buffer::Kind::staging),
      boxes_(arena_.take(count_ * sizeof(Box))),
      bounds_(arena_.take(6 * word)),
      indices_(arena_.take(count_ * word)),
      nodes_(arena_.take(2 * count_ * sizeof(Bvh2Node))),
      queue_(arena_.take(capacity_ * word)),
      children_(arena_.take(children_count_ * word)),
      scratch_(arena_.take(scratch_words() * word)),
      sum_room_(arena_.take(sum_.room_for(children_count_))),
      small_count_(arena_.take(word)) {}

void SahBuild::record_begin(vulkan::Commands& commands) {
  commands.mark("Rest");
  commands.fill(bounds_.part(0, 3 * word), ~0U);
  commands.fill(bounds_.part(3 * word, 3 * word), 0);
  commands.fill(small_count_, 0);
  if (params_.leaves.sah) commands.fill(nodes_, 0);
  commands.barrier();
  const BoundsPush bounds{scene_.vertices().address(), scene_.triangles().address(), boxes_.address(), bounds_.address(), count_};
  commands.run(kernels_.bounds, bounds, groups_of(count_, kernels_.group));
  commands.barrier();
  const BeginPush begin{bounds_.address(), indices_.address(), nodes_.address(), children_.address(), count_, small_};
  commands.run(kernels_.begin, begin, groups_of(count_, kernels_.group));
  commands.barrier();
}

void SahBuild::record_split(vulkan::Commands& commands, std::uint32_t active) {
  commands.mark("SAH split");
  commands.run(kernels_.split,
               SplitPush{boxes_.address(), indices_.address(), nodes_.address(), queue_.address(), children_.address(), active,
                         params_.leaves.sah ? params_.leaves.max_triangles : 0, params_.leaves.traversal,
                         params_.leaves.intersection, 1.0F / static_cast<float>(params_.samples + 1)},
               active);
  commands.barrier();
}

void SahBuild::record_reorder(vulkan::Commands& commands, std::uint32_t active) {
  commands.mark("Reorder");
  commands.run(kernels_.reorder,
               ReorderPush{boxes_.address(), indices_.address(), scratch_.address(), nodes_.address(), queue_.address(),
                           children_.address(), active, small_},
               active);
  commands.barrier();
}

void SahBuild::record_compaction(vulkan::Commands& commands, std::uint32_t children) {
  commands.mark("Compaction");
  const std::uint64_t groups = groups_of(children, kernels_.group);
  commands.run(kernels_.flags,
               FlagsPush{children_.address(), scratch_.address(), queue_.address(), small_count_.address(), children, capacity_},
               groups);
  commands.barrier();
  sum_.record(commands, scratch_, children, sum_room_);
  commands.run(kernels_.compact, CompactPush{children_.address(), scratch_.address(), queue_.address(), children}, groups);
  commands.copy(scratch_.part(children * word, word), readback_.all().part(0, word));
  commands.copy(small_count_, readback_.all().part(word, word));
}

SahBuild::Waiting SahBuild::finish(vulkan::Commands& commands) {
  const std::vector<vulkan::PartTime> parts = commands.finish();
  add_parts(parts_, parts);
  Waiting waiting{};
  std::memcpy(&waiting, readback_.mapped(), 2 * word);
  waiting.seconds = vulkan::total_seconds(parts);
  return waiting;
}

void SahBuild::run() {
  vulkan::Commands first(device_);
  record_begin(first);
  record_compaction(first, 1);
  Waiting waiting = finish(first);
  while (waiting.large > 0) {
    const std::uint32_t active = waiting.large;
    vulkan::Commands commands(device_);
    record_split(commands, active);
    record_reorder(commands, active);
    record_compaction(commands, 2 * active);
    waiting = finish(commands);
    levels_.push_back({waiting.seconds, static_cast<double>(active)});
  }
}

double SahBuild::download(Bvh2& bvh) const {
  const double seconds = download_tree(device_, nodes_, count_, indices_, count_, bvh);
  bvh.nodes[1] = {};
  if (params_.leaves.sah) drop_unused(bvh.nodes);
  return seconds;
}

}  // namespace raystudy::gpu
