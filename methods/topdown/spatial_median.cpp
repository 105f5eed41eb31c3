#include <utility>

#include "harness/method/registry.h"
#include "methods/topdown/record_build.h"

namespace raystudy {
namespace {

struct SpatialMedianSplitter {
  static std::uint32_t split(std::span<topdown::BoxRecord> records, const topdown::NodeBounds& bounds) {
    const Box box = bounds.box.box();
    const int axis = box.longest_axis();
    const float doubled_plane = box.lower[axis] + box.upper[axis];
    const auto goes_left = [=](const topdown::WideBox& b) {
      alignas(16) float center[4];
      topdown::hn::Store(topdown::doubled_center(b), topdown::Float4(), center);
      return center[axis] < doubled_plane;
    };
    const std::uint32_t left = topdown::partition_records(records, goes_left);
    if (left > 0 && left < records.size()) return left;
    return topdown::split_at_median(records, axis);
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
