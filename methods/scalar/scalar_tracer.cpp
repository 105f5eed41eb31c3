#include "harness/method/registry.h"
#include "methods/scalar/scalar_session.h"

namespace raystudy::scalar {

class ScalarTracer final : public Tracer {
 public:
  explicit ScalarTracer(const Params&) {}
  static MethodInfo info() {
    return {.name = "scalar",
            .summary = "one ray at a time, nearer child first, conservative slabs, watertight triangles",
            .citation = "Woop, Benthin, Wald 2013 (JCGT 2(1)); Ize 2013 (JCGT 2(2))",
            .accel = std::string(Bvh2::kind_name)};
  }
  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene& scene, int threads, bool) const override {
    return std::make_unique<ScalarSession>(dynamic_cast<const Bvh2&>(accel), scene, threads);
  }
};

const Registration<ScalarTracer> scalar_tracer;

}  // namespace raystudy::scalar
