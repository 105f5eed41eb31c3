#include "methods/vulkan/apetrei.h"

namespace raystudy::gpu {
namespace {

struct ApetreiPush {
  std::uint64_t boxes;
  std::uint64_t order;
  std::uint64_t leaf_first;
  std::uint64_t depths;
  std::uint64_t nodes;
  std::uint64_t ends;
  std::uint64_t roots;
  std::uint64_t treelets;
  std::uint32_t leaves;
};

}  // namespace

void record_apetrei(vulkan::Device& device, vulkan::Commands& commands, const LbvhLeaves& leaves, const ApetreiOutput& output) {
  const DeviceShape& shape = leaves.order().shape();
  const MortonOrder& order = leaves.order();
  const bool treelets = output.least_depth > 0;
  commands.fill(output.ends.part(0, leaves.count() * sizeof(std::uint32_t)), ~0U);
  commands.barrier();
  commands.run(
      device.kernel("lbvh_apetrei", {shape.group, 0, leaves.one_a_leaf() ? 1U : 0U, output.least_depth, shape.fences ? 1U : 0U}),
      ApetreiPush{order.boxes().address(), order.order().address(), leaves.first(), leaves.depths(), output.nodes.address(),
                  output.ends.address(), treelets ? output.roots.address() : 0, treelets ? output.treelets.address() : 0,
                  leaves.count()},
      groups_for(leaves.count(), shape.group));
  commands.barrier();
}

}  // namespace raystudy::gpu
