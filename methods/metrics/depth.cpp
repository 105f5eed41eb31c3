#include <algorithm>

#include "harness/accel/tree_walk.h"
#include "harness/method/registry.h"

namespace raystudy::metrics {

class Depth final : public Metric {
 public:
  explicit Depth(const Params&) {}
  static MethodInfo info() {
    return {.name = "depth",
            .summary = "depth of the deepest leaf and of the mean leaf; the root alone has depth 0",
            .citation = "harness/accel/bvh2.h",
            .accel = std::string(Bvh2::kind_name),
            .values = {{.name = "depth", .unit = "1", .summary = "depth of the deepest leaf, the root at 0"},
                       {.name = "mean_leaf_depth", .unit = "1", .summary = "mean depth of the leaves, the root at 0"}}};
  }
  [[nodiscard]] std::vector<MetricValue> measure(const Accel& accel, const Scene&, const BuildContext&) const override {
    const auto& bvh = dynamic_cast<const Bvh2&>(accel);
    std::uint32_t deepest = 0;
    std::uint64_t sum = 0;
    for_each_node(bvh, [&](const Bvh2Node& node, std::uint32_t depth) {
      if (!node.is_leaf()) return;
      deepest = std::max(deepest, depth);
      sum += depth;
    });
    const double leaves = std::max<double>(1, static_cast<double>(bvh.leaf_count()));
    return {{.name = "depth", .unit = "1", .values = {static_cast<double>(deepest)}},
            {.name = "mean_leaf_depth", .unit = "1", .values = {static_cast<double>(sum) / leaves}}};
  }
};

const Registration<Depth> depth;

}  // namespace raystudy::metrics
