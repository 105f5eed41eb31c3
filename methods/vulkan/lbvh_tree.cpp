#include "methods/vulkan/lbvh_tree.h"

#include <array>
#include <span>

#include "methods/vulkan/device_shape.h"
#include "methods/vulkan/download_tree.h"

namespace raystudy::gpu {
namespace {

struct DepthsPush {
  std::uint64_t low;
  std::uint64_t high;
  std::uint64_t depths;
  std::uint32_t count;
};
struct KeepPush {
  std::uint64_t depths;
  std::uint64_t kept;
  std::uint32_t count;
};
struct LeavesPush {
  std::uint64_t ranks;
  std::uint64_t depths;
  std::uint64_t leaf_first;
  std::uint64_t leaf_depths;
  std::uint32_t count;
};
struct ApetreiPush {
  std::uint64_t boxes;
  std::uint64_t order;
  std::uint64_t leaf_first;
  std::uint64_t depths;
  std::uint64_t nodes;
  std::uint64_t ends;
  std::uint32_t leaves;
};
struct KarrasPush {
  std::uint64_t low;
  std::uint64_t high;
  std::uint64_t leaf_first;
  std::uint64_t nodes;
  std::uint64_t slots;
  std::uint32_t leaves;
};
struct BoxesPush {
  std::uint64_t boxes;
  std::uint64_t order;
  std::uint64_t leaf_first;
  std::uint64_t depths;
  std::uint64_t slots;
  std::uint64_t nodes;
  std::uint64_t arrivals;
  std::uint32_t leaves;
};

constexpr std::size_t word = sizeof(std::uint32_t);

std::uint64_t address(const vulkan::Slice& slice) { return slice.buffer == nullptr ? 0 : slice.address(); }

std::uint64_t high_of(const MortonOrder& order) { return order.two_words() ? order.high().address() : 0; }

std::size_t room_of(const PrefixSum& sum, std::uint32_t n, std::uint32_t max_leaf_triangles) {
  if (max_leaf_triangles == 1) return 0;
  return vulkan::Arena::bytes_for({(std::size_t{n} + 1) * word, n * word, sum.room_for(n)});
}

}  // namespace

LbvhTree::LbvhTree(vulkan::Device& device, const MortonOrder& order, std::uint32_t max_leaf_triangles, Construction construction)
    : device_(device),
      order_(order),
      max_leaf_triangles_(max_leaf_triangles),
      construction_(construction),
      sum_(device),
      arena_(device, room_of(sum_, order.count(), max_leaf_triangles)),
      leaves_(order.count()) {
  if (max_leaf_triangles_ == 1) return;
  leaf_first_ = arena_.take((std::size_t{order.count()} + 1) * word);
  leaf_depths_ = arena_.take(order.count() * word);
}

/// Which splits are in nodes of more triangles than a leaf's, and so the leaves between them.
void LbvhTree::find_leaves(std::vector<vulkan::PartTime>& parts) {
  const DeviceShape shape = shape_of(device_);
  const std::uint32_t n = order_.count();
  const vulkan::Slice all_depths = order_.first_room();
  vulkan::Commands commands(device_);
  commands.mark("leaves");
  commands.run(device_.kernel("lbvh_depths", {shape.group, shape.items, 0, order_.two_words() ? 1U : 0U}),
               DepthsPush{order_.low().address(), high_of(order_), all_depths.address(), n},
               groups_for(n, shape.group * shape.items));
  commands.barrier();
  depths_ = all_depths;
  if (max_leaf_triangles_ > 1) {
    const vulkan::Slice ranks = order_.second_room();
    commands.run(device_.kernel("lbvh_keep", {shape.group, max_leaf_triangles_}),
                 KeepPush{all_depths.address(), ranks.address(), n}, groups_for(n, shape.group));
    commands.barrier();
    sum_.record(commands, ranks, n, arena_.take(sum_.room_for(n)));
    commands.run(device_.kernel("lbvh_leaves", {shape.group}),
                 LeavesPush{ranks.address(), all_depths.address(), leaf_first_.address(), leaf_depths_.address(), n},
                 groups_for(n, shape.group));
    commands.barrier();
    depths_ = leaf_depths_;
  }
  add_parts(parts, commands.finish());
  if (max_leaf_triangles_ == 1) return;
  std::array<std::uint32_t, 1> splits{};
  vulkan::download(device_, order_.second_room().part(n * word, word), std::as_writable_bytes(std::span(splits)));
  leaves_ = splits[0] + 1;
}

void LbvhTree::record_karras(vulkan::Commands& commands, const vulkan::Slice& slots, const vulkan::Slice& arrivals) const {
  const DeviceShape shape = shape_of(device_);
  const std::uint64_t groups = groups_for(leaves_, shape.group);
  const std::uint32_t one_a_leaf = max_leaf_triangles_ == 1 ? 1 : 0;
  commands.run(
      device_.kernel("lbvh_karras", {shape.group, 0, one_a_leaf, order_.two_words() ? 1U : 0U}),
      KarrasPush{order_.low().address(), high_of(order_), address(leaf_first_), nodes_->address(), slots.address(), leaves_},
      groups);
  commands.barrier();
  commands.mark("boxes");
  commands.run(device_.kernel("lbvh_boxes", {shape.climb_group, 0, one_a_leaf}),
               BoxesPush{order_.boxes().address(), order_.order().address(), address(leaf_first_), depths_.address(),
                         slots.address(), nodes_->address(), arrivals.address(), leaves_},
               groups_for(leaves_, shape.climb_group));
}

std::vector<vulkan::PartTime> LbvhTree::build() {
  std::vector<vulkan::PartTime> parts;
  find_leaves(parts);
  const DeviceShape shape = shape_of(device_);
  nodes_ = std::make_unique<vulkan::Buffer>(device_, 2 * std::size_t{leaves_} * sizeof(Bvh2Node));
  const vulkan::Slice ends = order_.second_room();
  const bool karras = construction_ == Construction::karras;
  const vulkan::Buffer slots(device_, karras ? leaves_ * word : word);
  vulkan::Commands commands(device_);
  commands.mark("hierarchy");
  commands.fill(ends.part(0, leaves_ * word), ~0U);
  commands.fill(nodes_->all().part(sizeof(Bvh2Node), sizeof(Bvh2Node)), 0);
  commands.barrier();
  if (karras) {
    record_karras(commands, slots.all(), ends);
  } else {
    commands.run(device_.kernel("lbvh_apetrei", {shape.climb_group, 0, max_leaf_triangles_ == 1 ? 1U : 0U}),
                 ApetreiPush{order_.boxes().address(), order_.order().address(), address(leaf_first_), depths_.address(),
                             nodes_->address(), ends.address(), leaves_},
                 groups_for(leaves_, shape.climb_group));
  }
  add_parts(parts, commands.finish());
  return parts;
}

}  // namespace raystudy::gpu
