#include "harness/method/frame_weights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "harness/accel/refit.h"

namespace raystudy {
namespace {

std::vector<float> measures_of(std::span<const Bvh2Node> nodes, const Measure& measure) {
  std::vector<Box> boxes(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) boxes[i] = nodes[i].box;
  std::vector<float> measures(nodes.size());
  measure.evaluate(boxes, measures);
  return measures;
}

}  // namespace

std::vector<float> frame_weights(std::span<const double> costs, std::span<const double> root_measures, double exponent) {
  std::vector<double> weights(costs.size());
  // Costs are divided by the largest: their powers stay within range, and nothing else changes.
  const double largest_cost = *std::max_element(costs.begin(), costs.end());
  for (std::size_t i = 0; i < costs.size(); ++i) {
    const double weight = largest_cost > 0 ? std::pow(costs[i] / largest_cost, exponent) : 1;
    weights[i] = weight / (root_measures[i] > 0 ? root_measures[i] : 1);
  }
  const double largest = *std::max_element(weights.begin(), weights.end());
  std::vector<float> scaled(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) scaled[i] = static_cast<float>(weights[i] / largest);
  return scaled;
}

std::vector<AlignedVector<Bvh2Node>> nodes_in_frames(const Bvh2& bvh, const Scene& scene,
                                                     std::span<const SharedArray<Vec3>> frames) {
  std::vector<AlignedVector<Bvh2Node>> all;
  if (bvh.empty()) return all;
  Bvh2 frame = bvh;
  Refitter refitter(bvh, scene.triangles, RefitMethod::serial, 1);
  for (const SharedArray<Vec3>& vertices : frames) {
    refitter.refit(frame, vertices);
    all.push_back(frame.nodes);
  }
  return all;
}

std::vector<float> weighted_measures(const Bvh2& bvh, const Scene& scene, std::span<const SharedArray<Vec3>> frames,
                                     double exponent, const CostModel& model) {
  std::vector<std::vector<float>> measures;
  std::vector<double> costs;
  std::vector<double> roots;
  Bvh2 frame = bvh;
  for (AlignedVector<Bvh2Node>& nodes : nodes_in_frames(bvh, scene, frames)) {
    measures.push_back(measures_of(nodes, *model.measure));
    roots.push_back(static_cast<double>(measures.back().front()));
    frame.nodes = std::move(nodes);
    costs.push_back(tree_cost(frame, model));
  }
  const std::vector<float> weights = frame_weights(costs, roots, exponent);
  std::vector<float> sums(bvh.nodes.size());
  for (std::size_t f = 0; f < measures.size(); ++f) {
    for (std::size_t n = 0; n < sums.size(); ++n) sums[n] += weights[f] * measures[f][n];
  }
  return sums;
}

double animation_cost(std::span<const double> costs, double exponent) {
  const double largest = *std::max_element(costs.begin(), costs.end());
  if (!(largest > 0)) return largest;
  double sum = 0;
  double weights = 0;
  for (const double cost : costs) {
    const double weight = std::pow(cost / largest, exponent);
    sum += weight * cost;
    weights += weight;
  }
  return sum / weights;
}

}  // namespace raystudy
