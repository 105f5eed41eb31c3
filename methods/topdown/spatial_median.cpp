#include <utility>

#include "harness/method/registry.h"
#include "methods/topdown/record_build.h"

namespace raystudy {
namespace {

struct SpatialMedianSplitter {
  static constexpr std::uint32_t few = 2;

  static topdown::Split split(std::span<const topdown::BoxRecord> records, const topdown::NodeBounds& bounds) {
    const Box box = bounds.box.box();
    const int axis = box.longest_axis();
    const topdown::Plane plane{axis, 0, 1, box.lower[axis] + box.upper[axis]};
    const std::size_t left = topdown::count_left(records, plane);
    return {plane, left < records.size() ? static_cast<std::uint32_t>(left) : 0};
  }
};

/// The longest axis of the node's box is cut in the middle; triangles whose box center lies below go left. Where all would go to
/// one side, the object median along that axis takes its place.
class SpatialMedian final : public Builder {
 public:
  explicit SpatialMedian(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "spatial-median",
            .summary = "top-down, the node's box cut in the middle of its longest axis",
            .citation = "Kaplan 1985; Wald 2007, Sec. 2",
            .params = topdown::LeafPolicy::params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const topdown::LeafPolicy leaves(params_, context.cost);
    return topdown::build_from_records(scene, context, leaves, *context.cost.measure, SpatialMedianSplitter{});
  }

 private:
  Params params_;
};

const Registration<SpatialMedian> registration;

}  // namespace
}  // namespace raystudy
