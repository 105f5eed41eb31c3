#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "harness/method/registry.h"
#include "methods/vulkan/ordered_build.h"
#include "methods/vulkan/ploc_tree.h"

namespace raystudy::gpu {
namespace {

class Ploc final : public Builder {
 public:
  explicit Ploc(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {
        .name = "gpu-ploc",
        .summary = "on a Vulkan device: merges clusters that are each other's nearest neighbours in a window of the Morton order",
        .citation =
            "Meister, Bittner: Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction, TVCG 24(3), 2018",
        .params = {integer_param("radius", 14, "r: how many places to either side of a cluster its neighbours are", 1, 128),
                   choice_param("morton_bits", {"60", "30", "63"}, "bits of the Morton codes that order the triangles")},
        .accel = std::string(Bvh2::kind_name),
        .on_device = true,
        .parts = {"bounds", "morton", "sort", "nearest", "merge", "layout"}};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto bits = static_cast<std::uint32_t>(std::stoi(params_.text("morton_bits")));
    return build_in_morton_order(scene, bits, context, [this](MortonOrder& order, auto& parts, Bvh2& bvh) {
      vulkan::Device& device = vulkan::Device::shared();
      PlocTree tree(device, order, static_cast<std::uint32_t>(params_.integer("radius")));
      tree.build(parts);
      return download_tree(device, tree.nodes(), order.count(), tree.triangles(), order.count(), bvh);
    });
  }

 private:
  Params params_;
};

const Registration<Ploc> registration;

}  // namespace
}  // namespace raystudy::gpu
