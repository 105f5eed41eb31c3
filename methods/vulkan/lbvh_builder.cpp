#include <cstdint>
#include <memory>
#include <string>
#include <utility>

#include "harness/method/registry.h"
#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/lbvh_tree.h"

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
    vulkan::Device& device = vulkan::Device::shared();
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    device.reset_peak_bytes();
    const DeviceScene on_device(device, scene);
    MortonOrder order(device, on_device, static_cast<std::uint32_t>(std::stoi(params_.text("morton_bits"))));
    std::vector<vulkan::PartTime> parts = order.build();
    LbvhLeaves leaves(device, order, static_cast<std::uint32_t>(params_.integer("max_leaf_triangles")));
    leaves.find(parts);
    LbvhTree tree(device, leaves, params_.text("construction") == "karras" ? Construction::karras : Construction::apetrei);
    tree.build(parts);
    const double download = download_tree(device, tree.nodes(), leaves.count(), order.order(), order.count(), *bvh);
    report(context.device, parts, on_device.upload_seconds(), download, device.peak_bytes());
    return bvh;
  }

 private:
  Params params_;
};

const Registration<Lbvh> registration;

}  // namespace
}  // namespace raystudy::gpu
