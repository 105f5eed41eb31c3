#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "methods/vulkan/lbvh_tree.h"
#include "methods/vulkan/ordered_build.h"
#include "methods/vulkan/treelet_tree.h"

namespace raystudy::gpu {
namespace {

class Hlbvh final : public Builder {
 public:
  explicit Hlbvh(Params params) : params_(std::move(params)) {
    if (params_.text("split") == "sah" && params_.integer("sah_bits") > std::stoi(params_.text("morton_bits"))) {
      throw Error(fmt::format("gpu-hlbvh: sah_bits is {}, but codes have {} bits (morton_bits); expected no more",
                              params_.integer("sah_bits"), params_.text("morton_bits")));
    }
  }

  static MethodInfo info() {
    return {
        .name = "gpu-hlbvh",
        .summary = "on a Vulkan device: treelets of Morton codes under a binned SAH, or the hierarchy of Morton codes alone",
        .citation =
            "Pantaleoni, Luebke: HLBVH: Hierarchical LBVH Construction for Real-Time Ray Tracing, 2010; Garanzha et al.: "
            "Simpler and Faster HLBVH with Work Queues, 2011",
        .params = {choice_param("split", {"sah", "median"}, "sah: of treelets by binned SAH; median: all by Morton codes"),
                   choice_param("morton_bits", {"30", "63"}, "bits of the Morton codes that order the triangles"),
                   integer_param("sah_bits", 15, "with split: sah, the leading bits of its code that a treelet shares", 1, 63),
                   integer_param("bins", 16, "with split: sah, bins an axis", 2, 128),
                   integer_param("max_leaf_triangles", 8, "a range of at most so many triangles is a leaf", 1, 64)},
        .accel = std::string(Bvh2::kind_name),
        .on_device = true,
        .parts = {"bounds", "morton", "sort", "leaves", "treelets", "hierarchy", "sah", "layout"}};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto bits = static_cast<std::uint32_t>(std::stoi(params_.text("morton_bits")));
    return build_in_morton_order(scene, bits, context, [this, bits](MortonOrder& order, auto& parts, Bvh2& bvh) {
      vulkan::Device& device = vulkan::Device::shared();
      const bool sah = params_.text("split") == "sah";
      const std::uint32_t least_depth = sah ? depth_of_prefix(bits, static_cast<std::uint32_t>(params_.integer("sah_bits"))) : 0;
      LbvhLeaves leaves(device, order, static_cast<std::uint32_t>(params_.integer("max_leaf_triangles")), least_depth);
      leaves.find(parts);
      if (sah) {
        TreeletTree tree(device, leaves, least_depth, static_cast<std::uint32_t>(params_.integer("bins")));
        tree.build(parts);
        return download_tree(device, tree.nodes(), leaves.count(), tree.triangles(), order.count(), bvh);
      }
      LbvhTree tree(device, leaves, Construction::apetrei);
      tree.build(parts);
      return download_tree(device, tree.nodes(), leaves.count(), order.order(), order.count(), bvh);
    });
  }

 private:
  Params params_;
};

const Registration<Hlbvh> registration;

}  // namespace
}  // namespace raystudy::gpu
