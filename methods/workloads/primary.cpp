#include "harness/method/registry.h"
#include "methods/workloads/camera_rays.h"

namespace raystudy::workloads {

class Primary final : public Workload {
 public:
  explicit Primary(const Params& params) : options_(params) {}
  static MethodInfo info() {
    return {.name = "primary",
            .summary = "closest hits of the rays a pinhole camera sends through its pixels",
            .citation = "Bittner, Hapala, Havran 2015, section 3 (primary rays)",
            .params = camera_params()};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext& context) const override {
    return camera_rays(scene, options_, context.seed);
  }

 private:
  CameraOptions options_;
};

const Registration<Primary> primary;

}  // namespace raystudy::workloads
