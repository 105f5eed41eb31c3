#include "harness/method/cost_model.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "harness/accel/tree_walk.h"

namespace raystudy {
namespace {

/// The nodes of a tree, its root first.
class NodeList {
 public:
  explicit NodeList(std::size_t expected) {
    boxes_.reserve(expected);
    triangles_.reserve(expected);
  }

  /// `triangles` is 0 of an inner node.
  void add(const Box& box, std::uint32_t triangles) {
    boxes_.push_back(box);
    triangles_.push_back(triangles);
  }

  [[nodiscard]] double cost(const CostModel& model) const {
    if (boxes_.empty()) return 0;
    std::vector<float> measures(boxes_.size());
    model.measure->evaluate(boxes_, measures);
    const bool flat = !(measures[0] > 0);
    double inner = 0;
    double leaf = 0;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const double m = flat ? 1.0 : static_cast<double>(measures[i]);
      if (triangles_[i] > 0) {
        leaf += m * triangles_[i];
      } else {
        inner += m;
      }
    }
    const double root = flat ? 1.0 : static_cast<double>(measures[0]);
    return (static_cast<double>(model.traversal) * inner + static_cast<double>(model.intersection) * leaf) / root;
  }

 private:
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace

void SurfaceArea::evaluate(std::span<const Box> boxes, std::span<float> out) const {
  for (std::size_t i = 0; i < boxes.size(); ++i) out[i] = boxes[i].half_area();
}

std::shared_ptr<const Measure> surface_area() {
  static const auto measure = std::make_shared<const SurfaceArea>();
  return measure;
}

double tree_cost(const Bvh2& bvh, const CostModel& model) {
  NodeList list(bvh.nodes.size());
  for_each_pair(bvh, [&list](const Bvh2Node& node) { list.add(node.box, node.count); });
  return list.cost(model);
}

double tree_cost(const WideBvh& bvh, const CostModel& model) {
  NodeList list(bvh.triangles.size());
  if (!bvh.empty()) list.add(bvh.bounds, 0);
  for_each_slot(bvh, [&list](const Box& box, std::uint32_t child) {
    list.add(box, WideChild::is_leaf(child) ? WideChild::count(child) : 0);
  });
  return list.cost(model);
}

}  // namespace raystudy
