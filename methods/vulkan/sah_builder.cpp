#include <memory>
#include <string>
#include <utility>

#include "harness/method/registry.h"
#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/sah_build.h"

namespace raystudy::gpu {
namespace {

std::vector<ParamSpec> sah_params() {
  std::vector<ParamSpec> specs{
      integer_param("samples", 64, "candidates an axis; nodes of no more triangles take the positions of their triangles", 1,
                    1024),
      integer_param("small_split", 32, "nodes of no more triangles (and samples) are built in one go, in shared memory; 0: none",
                    0, 64),
      integer_param("lbvh_levels", 0, "first levels that the foremost bits of Morton codes make; 6: the thesis' hybrid", 0,
                    LbvhLevels::most_levels)};
  for (ParamSpec& spec : topdown::LeafPolicy::params()) specs.push_back(std::move(spec));
  return specs;
}

/// Breadth-first construction by the surface area heuristic on a device, one workgroup a split.
class GpuSah final : public Builder {
 public:
  explicit GpuSah(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "gpu-sah",
            .summary = "on a Vulkan device: SAH over uniform samples, breadth first, one workgroup a split",
            .citation =
                "Lauterbach: Interactive Ray Tracing of Massive and Deformable Models, 2010, Sec. 5.2 and 5.3; Lauterbach et "
                "al.: Fast BVH Construction on GPUs, 2009, Sec. 4 and 5",
            .params = sah_params(),
            .accel = std::string(Bvh2::kind_name),
            .on_device = true,
            .parts = {"Rest", "LBVH", "SAH split", "Reorder", "Compaction", "Small splits"}};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    vulkan::Device& device = vulkan::Device::shared();
    device.reset_peak_bytes();
    const DeviceScene on_device(device, scene);
    SahBuild build(
        device, on_device,
        {topdown::LeafPolicy(params_, context.cost), static_cast<std::uint32_t>(params_.integer("samples")),
         static_cast<std::uint32_t>(params_.integer("small_split")), static_cast<std::uint32_t>(params_.integer("lbvh_levels"))});
    build.run();
    const double download = build.download(*bvh);
    report(context.device, build.parts(), on_device.upload_seconds(), download, device.peak_bytes());
    if (context.device != nullptr) context.device->levels = build.levels();
    return bvh;
  }

 private:
  Params params_;
};

const Registration<GpuSah> registration;

}  // namespace
}  // namespace raystudy::gpu
