#include "methods/topdown/top_down.h"

namespace raystudy::topdown {

std::vector<ParamSpec> LeafPolicy::params() {
  return {choice_param("leaves", {"single", "sah"}, "one triangle a leaf, or a leaf where it costs no more than the best split"),
          integer_param("max_leaf_triangles", 8, "with leaves: sah, the most triangles of a leaf", 1, 1 << 20)};
}

LeafPolicy::LeafPolicy(const Params& params, const CostModel& cost)
    : sah(params.text("leaves") == "sah"),
      max_triangles(static_cast<std::uint32_t>(params.integer("max_leaf_triangles"))),
      traversal(cost.traversal),
      intersection(cost.intersection) {}

}  // namespace raystudy::topdown
