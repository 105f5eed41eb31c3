#include "methods/vulkan/lbvh_tree.h"

#include "methods/vulkan/apetrei.h"
#include "methods/vulkan/download_tree.h"

namespace raystudy::gpu {
namespace {

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

}  // namespace

LbvhTree::LbvhTree(vulkan::Device& device, const LbvhLeaves& leaves, Construction construction)
    : device_(device),
      leaves_(leaves),
      construction_(construction),
      nodes_(device, 2 * std::size_t{leaves.count()} * sizeof(Bvh2Node)),
      slots_(device, construction == Construction::karras ? leaves.count() * word : 0) {}

void LbvhTree::record_karras(vulkan::Commands& commands) const {
  const DeviceShape& shape = leaves_.order().shape();
  const MortonOrder& order = leaves_.order();
  const std::uint32_t one_a_leaf = leaves_.one_a_leaf() ? 1 : 0;
  commands.run(device_.kernel("lbvh_karras", {shape.group, 0, one_a_leaf, order.two_words() ? 1U : 0U}),
               KarrasPush{order.low().address(), order.two_words() ? order.high().address() : 0, leaves_.first(),
                          nodes_.address(), slots_.address(), leaves_.count()},
               groups_for(leaves_.count(), shape.group));
  commands.barrier();
  commands.mark("boxes");
  commands.run(device_.kernel("lbvh_boxes", {shape.group, 0, one_a_leaf, 0, shape.fences ? 1U : 0U}),
               BoxesPush{order.boxes().address(), order.order().address(), leaves_.first(), leaves_.depths(), slots_.address(),
                         nodes_.address(), order.second_room().address(), leaves_.count()},
               groups_for(leaves_.count(), shape.group));
}

void LbvhTree::build(std::vector<vulkan::PartTime>& parts) {
  const vulkan::Slice& second_room = leaves_.order().second_room();
  vulkan::Commands commands(device_);
  commands.mark("hierarchy");
  commands.fill(nodes().part(sizeof(Bvh2Node), sizeof(Bvh2Node)), 0);
  if (construction_ == Construction::karras) {
    commands.fill(second_room.part(0, leaves_.count() * word), ~0U);
    commands.barrier();
    record_karras(commands);
  } else {
    record_apetrei(device_, commands, leaves_, {nodes(), second_room});
  }
  add_parts(parts, commands.finish());
}

}  // namespace raystudy::gpu
