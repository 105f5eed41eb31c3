#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "harness/method/registry.h"
#include "methods/vulkan/lbvh_tree.h"
#include "methods/vulkan/ordered_build.h"

namespace raystudy::gpu {
namespace {

class Lbvh final : public Builder {
 public:
  explicit Lbvh(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {
        .name = "gpu-lbvh",
        .summary = "on a Vulkan device: splits triangles in Morton order at the highest bit in which their codes differ",
        .citation =
            "Lauterbach et al.: Fast BVH Construction on GPUs, 2009; Karras: Maximizing Parallelism in the Construction "
            "of BVHs, Octrees, and k-d Trees, 2012; Apetrei: Fast and Simple Agglomerative LBVH Construction, 2014",
        .params = {choice_param("morton_bits", {"30", "63"}, "bits of the Morton codes that order the triangles"),
                   choice_param("construction", {"karras", "apetrei"},
                                "top-down searches, then boxes; or both in one pass from the leaves up. The tree is the same"),
                   integer_param("max_leaf_triangles", 1, "a range of at most so many triangles is a leaf", 1, 64)},
        .accel = std::string(Bvh2::kind_name),
        .on_device = true,
        .parts = {"bounds", "morton", "sort", "leaves", "hierarchy", "boxes"}};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto bits = static_cast<std::uint32_t>(std::stoi(params_.text("morton_bits")));
    return build_in_morton_order(scene, bits, context, [this](MortonOrder& order, auto& parts, Bvh2& bvh) {
      vulkan::Device& device = vulkan::Device::shared();
      LbvhLeaves leaves(device, order, static_cast<std::uint32_t>(params_.integer("max_leaf_triangles")));
      leaves.find(parts);
      LbvhTree tree(device, leaves, params_.text("construction") == "karras" ? Construction::karras : Construction::apetrei);
      tree.build(parts);
      return download_tree(device, tree.nodes(), leaves.count(), order.order(), order.count(), bvh);
    });
  }

 private:
  Params params_;
};

const Registration<Lbvh> registration;

}  // namespace
}  // namespace raystudy::gpu
