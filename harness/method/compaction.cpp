#include "harness/method/compaction.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "harness/accel/distinct_triangles.h"

namespace raystudy {
namespace {

std::vector<float> measures_of(const Bvh2& bvh, const Measure& measure) {
  std::vector<Box> boxes(bvh.nodes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) boxes[i] = bvh.nodes[i].box;
  std::vector<float> measures(boxes.size());
  measure.evaluate(boxes, measures);
  return measures;
}

/// For every node: the least cost its subtree can be compacted to (m(root) times Eq. 1), its triangles, and whether one leaf is
/// it.
class Collapse {
 public:
  Collapse(const Bvh2& bvh, std::vector<float> measures, const CostModel& model, std::uint32_t max_leaf_triangles)
      : bvh_(bvh), model_(model), max_leaf_triangles_(max_leaf_triangles), measures_(std::move(measures)) {
    if (!(measures_[0] > 0)) measures_.assign(measures_.size(), 1);
    costs_.resize(bvh.nodes.size());
    triangles_ = distinct_triangles(bvh);
    collapses_.resize(bvh.nodes.size());
    list_nodes();
    for (const std::uint32_t node : order_) visit(node);
  }

  [[nodiscard]] double cost() const { return costs_[0] / measures_[0]; }
  [[nodiscard]] bool collapses(std::uint32_t node) const { return collapses_[node] != 0; }

 private:
  /// Children before parents: nothing in Bvh2 promises that indices are in either order.
  void list_nodes() {
    order_.reserve(bvh_.nodes.size());
    order_.push_back(0);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Bvh2Node& node = bvh_.nodes[order_[i]];
      if (node.is_leaf()) continue;
      order_.push_back(node.first);
      order_.push_back(node.first + 1);
    }
    std::reverse(order_.begin(), order_.end());
  }

  void visit(std::uint32_t i) {
    const Bvh2Node& node = bvh_.nodes[i];
    const auto m = static_cast<double>(measures_[i]);
    const double leaf = static_cast<double>(model_.intersection) * m * triangles_[i];
    if (node.is_leaf()) {
      costs_[i] = leaf;
      return;
    }
    const double subtree = static_cast<double>(model_.traversal) * m + costs_[node.first] + costs_[node.first + 1];
    const bool fits = max_leaf_triangles_ == 0 || triangles_[i] <= max_leaf_triangles_;
    collapses_[i] = fits && subtree > leaf ? 1 : 0;
    costs_[i] = collapses_[i] != 0 ? leaf : subtree;
  }

  const Bvh2& bvh_;
  const CostModel& model_;
  std::uint32_t max_leaf_triangles_;
  std::vector<float> measures_;
  std::vector<std::uint32_t> order_;
  std::vector<double> costs_;
  std::vector<std::uint32_t> triangles_;
  std::vector<std::uint8_t> collapses_;
};

/// Copies what remains of a tree, depth first.
class Writer {
 public:
  Writer(const Bvh2& from, const Collapse& collapse) : from_(from), collapse_(collapse) {
    if (from.duplicates) last_leaf_.assign(triangle_limit(from), std::numeric_limits<std::uint32_t>::max());
  }

  Bvh2 write() {
    to_.duplicates = from_.duplicates;
    to_.nodes.resize(2);
    to_.triangles.reserve(from_.triangles.size());
    struct Task {
      std::uint32_t source;
      std::uint32_t target;
    };
    std::vector<Task> stack{{0, 0}};
    while (!stack.empty()) {
      const auto [source, target] = stack.back();
      stack.pop_back();
      const Bvh2Node& node = from_.nodes[source];
      if (node.is_leaf() || collapse_.collapses(source)) {
        const auto first = static_cast<std::uint32_t>(to_.triangles.size());
        append_triangles(source, target);
        to_.nodes[target] = {node.box, first, static_cast<std::uint32_t>(to_.triangles.size()) - first};
        continue;
      }
      const auto children = static_cast<std::uint32_t>(to_.nodes.size());
      to_.nodes.resize(children + 2);
      to_.nodes[target] = {node.box, children, 0};
      stack.push_back({node.first + 1, children + 1});
      stack.push_back({node.first, children});
    }
    return std::move(to_);
  }

 private:
  /// The triangles under `root`, each once.
  void append_triangles(std::uint32_t root, std::uint32_t target) {
    std::vector<std::uint32_t> stack{root};
    while (!stack.empty()) {
      const Bvh2Node& node = from_.nodes[stack.back()];
      stack.pop_back();
      if (node.is_leaf()) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const std::uint32_t triangle = from_.triangles[i];
          if (from_.duplicates && std::exchange(last_leaf_[triangle], target) == target) continue;
          to_.triangles.push_back(triangle);
        }
      } else {
        stack.push_back(node.first + 1);
        stack.push_back(node.first);
      }
    }
  }

  const Bvh2& from_;
  const Collapse& collapse_;
  Bvh2 to_;
  std::vector<std::uint32_t> last_leaf_;  ///< of each triangle the last leaf it was written to, with duplicates
};

}  // namespace

void compact(Bvh2& bvh, const CostModel& model, std::uint32_t max_leaf_triangles) {
  if (!bvh.empty()) compact(bvh, measures_of(bvh, *model.measure), model, max_leaf_triangles);
}

void compact(Bvh2& bvh, std::vector<float> measures, const CostModel& model, std::uint32_t max_leaf_triangles) {
  if (bvh.empty()) return;
  const Collapse collapse(bvh, std::move(measures), model, max_leaf_triangles);
  bvh = Writer(bvh, collapse).write();
}

double compacted_cost(const Bvh2& bvh, const CostModel& model, std::uint32_t max_leaf_triangles) {
  return bvh.empty() ? 0 : Collapse(bvh, measures_of(bvh, *model.measure), model, max_leaf_triangles).cost();
}

}  // namespace raystudy
