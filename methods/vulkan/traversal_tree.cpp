#include "methods/vulkan/traversal_tree.h"

#include <fmt/format.h>

#include "harness/accel/tree_height.h"
#include "harness/base/error.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/device_scene.h"
#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {
namespace {

constexpr std::uint32_t leaf_bit = 0x80000000U;
constexpr std::size_t pair_bytes = 64;
constexpr std::size_t triangle_bytes = 40;

struct TrianglesPush {
  std::uint64_t vertices;
  std::uint64_t triangles;
  std::uint64_t order;
  std::uint64_t leaf_triangles;
  std::uint32_t count;
};
struct PairsPush {
  std::uint64_t nodes;
  std::uint64_t pairs;
  std::uint64_t leaf_triangles;
  std::uint32_t count;
};

std::size_t checked_bytes(const Bvh2& bvh) {
  if (bvh.triangles.size() >= leaf_bit - 1) {
    throw Error(fmt::format("a tree of {} triangles; the tracer 'gpu' takes fewer than {}", bvh.triangles.size(), leaf_bit - 1));
  }
  return vulkan::Arena::bytes_for({bvh.nodes.size() / 2 * pair_bytes, bvh.triangles.size() * triangle_bytes});
}

}  // namespace

TraversalTree::TraversalTree(vulkan::Device& device, const Bvh2& bvh, const Scene& scene)
    : arena_(device, checked_bytes(bvh)),
      pairs_(arena_.take(bvh.nodes.size() / 2 * pair_bytes)),
      triangles_(arena_.take(bvh.triangles.size() * triangle_bytes)),
      root_(bvh.nodes[0].is_leaf() ? bvh.nodes[0].first | leaf_bit : bvh.nodes[0].first / 2),
      bounds_(bvh.nodes[0].box),
      height_(static_cast<std::uint32_t>(tree_height(bvh))) {
  const DeviceScene on_device(device, scene);
  const vulkan::Buffer nodes(device, bvh.nodes.size() * sizeof(Bvh2Node));
  const vulkan::Buffer order(device, bvh.triangles.size() * sizeof(std::uint32_t));
  vulkan::upload(device, nodes.all(), std::as_bytes(std::span(bvh.nodes.data(), bvh.nodes.size())));
  vulkan::upload(device, order.all(), std::as_bytes(std::span(bvh.triangles)));

  const std::uint32_t group = shape_of(device).group;
  const auto triangle_count = static_cast<std::uint32_t>(bvh.triangles.size());
  const auto node_count = static_cast<std::uint32_t>(bvh.nodes.size());
  vulkan::Commands commands(device);
  commands.run(device.kernel("traversal_triangles", {group}),
               TrianglesPush{on_device.vertices().address(), on_device.triangles().address(), order.address(),
                             triangles_.address(), triangle_count},
               groups_for(triangle_count, group));
  commands.barrier();
  commands.run(device.kernel("traversal_pairs", {group}),
               PairsPush{nodes.address(), pairs_.address(), triangles_.address(), node_count}, groups_for(node_count, group));
  commands.finish();
}

}  // namespace raystudy::gpu
