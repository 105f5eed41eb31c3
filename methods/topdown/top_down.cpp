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

void compact(Bvh2& bvh) {
  if (bvh.empty()) return;
  // Pairs are visited in the order of their slots, so that a pair only ever moves down, onto slots that were moved before.
  std::uint32_t next = 2;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    Bvh2Node& node = bvh.nodes[stack.back()];
    stack.pop_back();
    if (node.is_leaf()) continue;
    bvh.nodes[next] = bvh.nodes[node.first];
    bvh.nodes[next + 1] = bvh.nodes[node.first + 1];
    node.first = next;
    stack.push_back(next + 1);
    stack.push_back(next);
    next += 2;
  }
  bvh.nodes.resize(next);
}

}  // namespace raystudy::topdown
