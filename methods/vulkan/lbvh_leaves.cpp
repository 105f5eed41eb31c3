#include "methods/vulkan/lbvh_leaves.h"

#include <array>
#include <span>

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
  std::uint64_t masks;
  std::uint64_t counts;
  std::uint32_t count;
};
struct LeavesPush {
  std::uint64_t masks;
  std::uint64_t ranks;
  std::uint64_t depths;
  std::uint64_t leaf_first;
  std::uint64_t leaf_depths;
  std::uint32_t count;
};

constexpr std::size_t word = sizeof(std::uint32_t);
constexpr std::uint32_t places = 8;  // of a mask: shaders/places.glsl

std::uint32_t masks_of(std::uint32_t n) { return static_cast<std::uint32_t>(groups_for(n, places)); }

std::size_t room_of(const PrefixSum& sum, std::uint32_t n, bool one_a_leaf) {
  if (one_a_leaf) return 0;
  const std::size_t masks = masks_of(n);
  return vulkan::Arena::bytes_for({(std::size_t{n} + 1) * word, n * word, masks * word, (masks + 1) * word, sum.room_for(masks)});
}

}  // namespace

std::uint32_t read_word(vulkan::Device& device, const vulkan::Slice& words, std::size_t index) {
  std::array<std::uint32_t, 1> read{};
  vulkan::download(device, words.part(index * word, word), std::as_writable_bytes(std::span(read)));
  return read[0];
}

LbvhLeaves::LbvhLeaves(vulkan::Device& device, const MortonOrder& order, std::uint32_t max_leaf_triangles,
                       std::uint32_t least_depth)
    : device_(device),
      order_(order),
      max_leaf_triangles_(max_leaf_triangles),
      least_depth_(least_depth),
      one_a_leaf_(max_leaf_triangles == 1 && least_depth == 0),
      count_(order.count()),
      sum_(device, order.shape()),
      arena_(device, room_of(sum_, order.count(), one_a_leaf_)) {
  if (one_a_leaf_) return;
  first_ = arena_.take((std::size_t{count_} + 1) * word);
  depths_ = arena_.take(count_ * word);
  masks_ = arena_.take(masks_of(count_) * word);
  ranks_ = arena_.take((masks_of(count_) + 1) * word);
  sum_room_ = arena_.take(sum_.room_for(masks_of(count_)));
}

void LbvhLeaves::find(std::vector<vulkan::PartTime>& parts) {
  const DeviceShape& shape = order_.shape();
  const std::uint32_t n = order_.count();
  const std::uint64_t depths = order_.first_room().address();
  const std::uint64_t high = order_.two_words() ? order_.high().address() : 0;
  vulkan::Commands commands(device_);
  commands.mark("leaves");
  commands.run(device_.kernel("lbvh_depths", {shape.group, shape.items, 0, order_.two_words() ? 1U : 0U}),
               DepthsPush{order_.low().address(), high, depths, n}, groups_for(n, shape.group * shape.items));
  commands.barrier();
  if (!one_a_leaf_) {
    const std::uint32_t masks = masks_of(n);
    const std::uint64_t groups = groups_for(masks, shape.group);
    commands.run(device_.kernel("lbvh_keep", {shape.group, max_leaf_triangles_, least_depth_}),
                 KeepPush{depths, masks_.address(), ranks_.address(), n}, groups);
    commands.barrier();
    sum_.record(commands, ranks_, masks, sum_room_);
    commands.run(device_.kernel("lbvh_leaves", {shape.group}),
                 LeavesPush{masks_.address(), ranks_.address(), depths, first_.address(), depths_.address(), n}, groups);
    commands.barrier();
  }
  add_parts(parts, commands.finish());
  if (!one_a_leaf_) count_ = read_word(device_, ranks_, masks_of(n)) + 1;
}

}  // namespace raystudy::gpu
