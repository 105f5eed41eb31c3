#include "harness/method/cost_model.h"

#include <cstddef>
#include <vector>

namespace raystudy {

void SurfaceArea::evaluate(std::span<const Box> boxes, std::span<float> out) const {
  for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = boxes[i].half_area();
}

std::shared_ptr<const Measure> surface_area() {
  static const auto measure = std::make_shared<const SurfaceArea>();
  return measure;
}

double tree_cost(const Bvh2& bvh, const CostModel& model) {
  if (bvh.empty()) return 0;
  std::vector<Box> boxes(bvh.nodes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = bvh.nodes[i].box;
  std::vector<float> measures(boxes.size());
  model.measure->evaluate(boxes, measures);
  const bool flat = !(measures[0] > 0);
  double inner = 0;
  double leaf = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (i == 1) continue;  // padding
    const double m = flat ? 1.0 : static_cast<double>(measures[i]);
    if (bvh.nodes[i].is_leaf()) {
      leaf += m * bvh.nodes[i].count;
    } else {
      inner += m;
    }
  }
  const double root = flat ? 1.0 : static_cast<double>(measures[0]);
  return (static_cast<double>(model.traversal) * inner + static_cast<double>(model.intersection) * leaf) / root;
}

}  // namespace raystudy
