#include "harness/method/registry.h"
#include "methods/vulkan/trace_session.h"

namespace raystudy::gpu {

class GpuTracer final : public Tracer {
 public:
  explicit GpuTracer(const Params& params) : persistent_(params.boolean("persistent")) {}
  static MethodInfo info() {
    return {.name = "gpu",
            .summary = "one ray an invocation of a Vulkan device: while-while traversal, watertight triangles",
            .citation = "Aila and Laine 2009; Woop, Benthin, Wald 2013; Ize 2013",
            .params = {boolean_param("persistent", false, "invocations fetch rays until there are none, instead of one each")},
            .accel = std::string(Bvh2::kind_name),
            .on_device = true};
  }
  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene& scene, int /*threads*/,
                                                      bool /*coherent*/) const override {
    vulkan::Device& device = vulkan::Device::shared();
    TraceShape shape = trace_shape_of(device);
    shape.persistent = persistent_;
    return std::make_unique<GpuTraceSession>(device, dynamic_cast<const Bvh2&>(accel), scene, shape);
  }

 private:
  bool persistent_;
};

const Registration<GpuTracer> gpu_tracer;

}  // namespace raystudy::gpu
