#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// The surface area heuristic: the chance that a uniformly distributed line which meets a convex body also meets a convex body
/// inside it is the ratio of their surface areas.
class SurfaceAreaHeuristic final : public Heuristic {
 public:
  explicit SurfaceAreaHeuristic(const Params&) {}

  static MethodInfo info() {
    return {.name = "surface-area",
            .summary = "surface area of a box: right for uniformly distributed rays that nothing stops",
            .citation = "Goldsmith and Salmon 1987; MacDonald and Booth 1990, Sec. 3"};
  }

  [[nodiscard]] std::shared_ptr<const Measure> prepare(const Scene&, const BuildContext&) const override {
    return surface_area();
  }
};

const Registration<SurfaceAreaHeuristic> registration;

}  // namespace
}  // namespace raystudy
