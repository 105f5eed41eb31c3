#include <utility>

#include "harness/method/registry.h"
#include "methods/topdown/record_build.h"

namespace raystudy {
namespace {

struct ObjectMedianSplitter {
  static constexpr std::uint32_t few = 2;

  static topdown::Split split(std::span<const topdown::BoxRecord>, const topdown::NodeBounds& bounds) {
    return {{.axis = bounds.box.box().longest_axis()}, 0};
  }
};

/// Half of the triangles go to each side: those with the lower box centers along the longest axis of the node's box to the left,
/// floor(n / 2) of them; equal centers by index.
class ObjectMedian final : public Builder {
 public:
  explicit ObjectMedian(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "object-median",
            .summary = "top-down, half of the triangles to each side along the longest axis",
            .citation = "Kay and Kajiya 1986; Goldsmith and Salmon 1987",
            .params = topdown::LeafPolicy::params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const topdown::LeafPolicy leaves(params_, context.cost);
    return topdown::build_from_records(scene, context, leaves, *context.cost.measure, ObjectMedianSplitter{});
  }

 private:
  Params params_;
};

const Registration<ObjectMedian> registration;

}  // namespace
}  // namespace raystudy
