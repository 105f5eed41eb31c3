#include "methods/vulkan/sah_build.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <vector>

#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/order_pushes.h"

namespace raystudy::gpu {
namespace {

constexpr std::size_t word = sizeof(std::uint32_t);

struct BeginPush {
  std::uint64_t bounds;
  std::uint64_t indices;
  std::uint64_t nodes;
  std::uint32_t count;
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

struct SmallPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t nodes;
  std::uint64_t queue;
  std::uint32_t capacity;
  std::uint32_t count;
  std::uint32_t max_leaf;
  float traversal;
  float intersection;
};

std::uint32_t reorder_group(const vulkan::Device& device) { return device.info().type == "cpu" ? 8 : 128; }

/// Most triangles of a node for the small-split kernel, whose candidates are the positions of triangles. 1: there are none.
std::uint32_t small_of(const SahParams& params) { return std::max(std::min(params.small_split, params.samples), 1U); }

/// The most children of a level: of nodes that are not small, and of those that came from elsewhere, whatever their size.
std::uint32_t most_children(std::uint32_t n, std::uint32_t small, std::uint32_t lbvh_levels) {
  return 2 * (n / (small + 1) + 2 * LargeSplits::most_nodes(n) + (1U << lbvh_levels));
}

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
      bounds(device.kernel("bounds", {group, shape_of(device).items})),
      begin(device.kernel("sah_begin", {group})),
      split(device.kernel("sah_split", candidate_constants(device, params.samples))),
      reorder(device.kernel("sah_reorder", {reorder_group(device)})),
      flags(device.kernel("sah_flags", {group})),
      compact(device.kernel("sah_compact", {group})),
      small(device.kernel("sah_small", {small_of(params), params.samples, 3})) {}

SahBuild::SahBuild(vulkan::Device& device, const DeviceScene& scene, const SahParams& params)
    : device_(device),
      scene_(scene),
      params_(params),
      count_(scene.triangle_count()),
      small_(small_of(params)),
      capacity_(std::max(count_ / 2, 1U)),
      children_count_(most_children(count_, small_, params.lbvh_levels)),
      sum_(device),
      kernels_(device, params),
      arena_(device, vulkan::Arena::bytes_for({6 * word, capacity_ * word, children_count_ * word, word, count_ * sizeof(Box),
                                               count_ * word, 2 * count_ * sizeof(Bvh2Node),
                                               (std::max(count_, children_count_) + 1) * word, sum_.room_for(children_count_)})),
      readback_(device, 2 * word, vulkan::Buffer::Kind::staging),
      bounds_(arena_.take(6 * word)),
      queue_(arena_.take(capacity_ * word)),
      children_(arena_.take(children_count_ * word)),
      small_count_(arena_.take(word)),
      memory_{.boxes = arena_.take(count_ * sizeof(Box)),
              .indices = arena_.take(count_ * word),
              .nodes = arena_.take(2 * count_ * sizeof(Bvh2Node)),
              .scratch = arena_.take((std::max(count_, children_count_) + 1) * word),
              .sum_room = arena_.take(sum_.room_for(children_count_))} {
  if (count_ > LargeSplits::segment) large_splits_.emplace(device, memory_, params, count_);
  if (params.lbvh_levels > 0) lbvh_levels_.emplace(device, memory_, params.lbvh_levels, count_);
}

void SahBuild::begin() {
  vulkan::Commands commands(device_);
  commands.mark("Rest");
  commands.fill(bounds_.part(0, 3 * word), ~0U);
  commands.fill(bounds_.part(3 * word, 3 * word), 0);
  commands.fill(small_count_, 0);
  if (params_.leaves.sah) commands.fill(memory_.nodes, 0);
  commands.barrier();
  commands.run(
      kernels_.bounds,
      BoundsPush{scene_.vertices().address(), scene_.triangles().address(), memory_.boxes.address(), bounds_.address(), count_},
      groups_for(count_, std::uint64_t{kernels_.group} * shape_of(device_).items));
  commands.barrier();
  commands.run(kernels_.begin, BeginPush{bounds_.address(), memory_.indices.address(), memory_.nodes.address(), count_},
               groups_for(count_, kernels_.group));
  finish(commands);
  if (!lbvh_levels_) {
    add(std::vector<SahNode>{{0, 0, count_}});
    return;
  }
  add(lbvh_levels_->build(bounds_, parts_));
  lbvh_levels_.reset();  // its memory is free for the levels that have most nodes
}

void SahBuild::add(std::span<const SahNode> nodes) {
  for (const SahNode& node : nodes) {
    if (node.count > LargeSplits::segment) {
      large_.push_back(node);
    } else if (node.count > 1) {
      joining_.push_back(node.node);
    }
  }
}

void SahBuild::record_split(vulkan::Commands& commands) {
  commands.mark("SAH split");
  if (!large_.empty()) large_splits_->record_splits(commands, large_);
  commands.run(kernels_.split,
               SplitPush{memory_.boxes.address(), memory_.indices.address(), memory_.nodes.address(), queue_.address(),
                         children_.address(), active_, params_.max_leaf(), params_.leaves.traversal, params_.leaves.intersection,
                         params_.spacing()},
               active_);
  commands.barrier();
}

void SahBuild::record_reorder(vulkan::Commands& commands) {
  commands.mark("Reorder");
  if (!large_.empty()) large_splits_->record_reorder(commands, large_);
  commands.run(kernels_.reorder,
               ReorderPush{memory_.boxes.address(), memory_.indices.address(), memory_.scratch.address(), memory_.nodes.address(),
                           queue_.address(), children_.address(), active_, small_},
               active_);
  commands.barrier();
}

void SahBuild::record_compaction(vulkan::Commands& commands) {
  commands.mark("Compaction");
  if (!large_.empty()) large_splits_->record_results(commands, large_);
  const std::uint32_t children = 2 * active_;
  const std::uint64_t groups = groups_for(children, kernels_.group);
  const vulkan::Slice& places = memory_.scratch;
  commands.run(kernels_.flags,
               FlagsPush{children_.address(), places.address(), queue_.address(), small_count_.address(), children, capacity_},
               groups);
  commands.barrier();
  sum_.record(commands, places, children, memory_.sum_room);
  commands.run(kernels_.compact, CompactPush{children_.address(), places.address(), queue_.address(), children}, groups);
  commands.copy(places.part(children * word, word), readback_.all().part(0, word));
  commands.copy(small_count_, readback_.all().part(word, word));
}

double SahBuild::finish(vulkan::Commands& commands) {
  const std::vector<vulkan::PartTime> parts = commands.finish();
  add_parts(parts_, parts);
  return vulkan::total_seconds(parts);
}

void SahBuild::run_level() {
  vulkan::upload(device_, queue_.part(active_ * word, joining_.size() * word), std::span<const std::uint32_t>(joining_));
  active_ += static_cast<std::uint32_t>(joining_.size());
  joining_.clear();
  vulkan::Commands commands(device_);
  record_split(commands);
  record_reorder(commands);
  record_compaction(commands);
  const double seconds = finish(commands);
  levels_.push_back({seconds, static_cast<double>(active_ + large_.size())});
  std::memcpy(&active_, readback_.mapped(), word);
  std::memcpy(&small_active_, readback_.mapped() + word, word);
  if (large_.empty()) return;
  const std::vector<SahNode> children = large_splits_->children(large_);
  large_.clear();
  add(children);
}

void SahBuild::run_small() {
  vulkan::Commands commands(device_);
  commands.mark("Small splits");
  commands.run(kernels_.small,
               SmallPush{memory_.boxes.address(), memory_.indices.address(), memory_.nodes.address(), queue_.address(), capacity_,
                         small_active_, params_.max_leaf(), params_.leaves.traversal, params_.leaves.intersection},
               small_active_);
  const double seconds = finish(commands);
  levels_.push_back({seconds, static_cast<double>(small_active_)});
}

void SahBuild::run() {
  begin();
  while (active_ > 0 || !joining_.empty() || !large_.empty()) run_level();
  if (small_active_ > 0) run_small();
}

double SahBuild::download(Bvh2& bvh) const {
  const double seconds = download_tree(device_, memory_.nodes, count_, memory_.indices, count_, bvh);
  bvh.nodes[1] = {};
  if (params_.leaves.sah) drop_unused(bvh.nodes);
  return seconds;
}

}  // namespace raystudy::gpu
