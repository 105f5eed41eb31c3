#include "harness/accel/tree_walk.h"
#include "harness/method/registry.h"

namespace raystudy::metrics {

/// Sums are over the root's surface area, so that c_T times the first series and (with one triangle a leaf) c_I times the second
/// add up to the cost. A root without area gives zeros.
class AreaByDepth final : public Metric {
 public:
  explicit AreaByDepth(const Params&) {}
  static MethodInfo info() {
    return {.name = "area-by-depth",
            .summary = "sums of the surface areas of inner nodes and of leaves at each depth, over the root's",
            .citation = "Bittner, Hapala, Havran 2015, Fig. 7",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "inner_area_by_depth",
                        .unit = "1",
                        .summary = "sum of the surface areas of the inner nodes at a depth, over the root's",
                        .axis = "depth"},
                       {.name = "leaf_area_by_depth",
                        .unit = "1",
                        .summary = "sum of the surface areas of the leaves at a depth, over the root's",
                        .axis = "depth"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext&) const override {
    const auto& bvh = dynamic_cast<const Bvh2&>(accel);
    MetricValue inner{.name = "inner_area_by_depth", .unit = "1", .values = {}, .x = "depth"};
    MetricValue leaf{.name = "leaf_area_by_depth", .unit = "1", .values = {}, .x = "depth"};
    const double root = bvh.empty() ? 0 : static_cast<double>(bvh.nodes[0].box.half_area());
    for_each_node(bvh, [&](const Bvh2Node& node, std::uint32_t depth) {
      if (depth >= inner.values.size()) {
        inner.values.resize(depth + 1);
        leaf.values.resize(depth + 1);
      }
      auto& sums = node.is_leaf() ? leaf.values : inner.values;
      if (root > 0) sums[depth] += static_cast<double>(node.box.half_area()) / root;
    });
    return {std::move(inner), std::move(leaf)};
  }
};

const Registration<AreaByDepth> area_by_depth;

}  // namespace raystudy::metrics
