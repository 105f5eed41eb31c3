#include "harness/method/tree_figures.h"

#include <algorithm>
#include <stdexcept>

#include "harness/accel/tree_walk.h"

namespace raystudy {
namespace {

TreeFigures figures_of(const Bvh2& bvh) {
  TreeFigures figures{.inner_nodes = bvh.inner_count(), .leaves = bvh.leaf_count()};
  for_each_node(bvh, [&figures](const Bvh2Node& node, std::uint32_t depth) {
    figures.depth = std::max(figures.depth, depth);
    figures.references += node.count;
  });
  return figures;
}

TreeFigures figures_of(const WideBvh& bvh) {
  TreeFigures figures{.references = bvh.triangles.size(), .depth = bvh.height};
  figures.inner_nodes = bvh.visit([](const auto& nodes) { return nodes.size(); });
  for_each_slot(bvh, [&figures](const Box&, std::uint32_t child) {
    if (WideChild::is_leaf(child)) ++figures.leaves;
  });
  return figures;
}

template <class Tree>
TreeFigures with_cost(const Tree& tree, const CostModel& model) {
  TreeFigures figures = figures_of(tree);
  figures.cost = tree_cost(tree, model);
  return figures;
}

}  // namespace

TreeFigures tree_figures(const Accel& tree, const CostModel& model) {
  if (const auto* bvh = dynamic_cast<const Bvh2*>(&tree)) return with_cost(*bvh, model);
  if (const auto* wide = dynamic_cast<const WideBvh*>(&tree)) return with_cost(*wide, model);
  throw std::logic_error("tree_figures: neither a Bvh2 nor a WideBvh");
}

}  // namespace raystudy
