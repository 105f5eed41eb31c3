#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "harness/accel/pair_tree.h"
#include "harness/method/frame_weights.h"
#include "harness/method/method.h"
#include "methods/insertion/frame_boxes.h"
#include "methods/insertion/optimization.h"

namespace raystudy::tsah {

/// Each frame's cost of a whole tree over several frames, under its own measure and not the weighted one.
template <class Tree>
class FrameCosts {
 public:
  FrameCosts(const CostModel& model, std::size_t frames) : model_(model), inner_(frames), leaves_(frames), roots_(frames) {}

  const std::vector<double>& of(const Tree& tree) {
    std::fill(inner_.begin(), inner_.end(), 0);
    std::fill(leaves_.begin(), leaves_.end(), 0);
    for (std::size_t p = 0; p < tree.pairs.size(); ++p) {
      const auto& pair = tree.pairs[p];
      const auto both = pair.boxes.both();
      for (std::size_t side = 0; side < (p == 0 ? 1U : 2U); ++side) add(tree, both, side, pair.link[side]);
    }
    costs_.resize(roots_.size());
    measure_roots(tree);
    for (std::size_t f = 0; f < roots_.size(); ++f) {
      const double sum =
          static_cast<double>(model_.traversal) * inner_[f] + static_cast<double>(model_.intersection) * leaves_[f];
      costs_[f] = sum / (roots_[f] > 0 ? roots_[f] : 1);
    }
    return costs_;
  }
  /// The root's measure in each frame.
  const std::vector<double>& measure_roots(const Tree& tree) {
    const auto top = tree.pairs[0].boxes.both();
    for (std::size_t f = 0; f < roots_.size(); ++f) roots_[f] = static_cast<double>(measured(top.box(f, 0)));
    return roots_;
  }

 private:
  void add(const Tree& tree, const typename Tree::Doubled& both, std::size_t side, std::uint32_t link) {
    const bool leaf = Tree::is_leaf(link);
    const double triangles = leaf ? tree.leaves[link & ~Tree::leaf_bit].count : 0;
    for (std::size_t f = 0; f < roots_.size(); ++f) {
      const auto m = static_cast<double>(measured(both.box(f, side)));
      if (leaf) {
        leaves_[f] += m * triangles;
      } else {
        inner_[f] += m;
      }
    }
  }
  [[nodiscard]] float measured(const Box& box) const {
    float m = 0;
    model_.measure->evaluate({&box, 1}, {&m, 1});
    return m;
  }

  const CostModel& model_;
  std::vector<double> inner_;
  std::vector<double> leaves_;
  std::vector<double> roots_;
  std::vector<double> costs_;
};

/// The insertion-based optimization of `bvh` over several representative frames (Bittner and Meister 2015, Section 5.1). Leaves
/// `bvh` with the boxes of the first frame.
template <class Boxes>
void optimize_over_frames(Bvh2& bvh, const Scene& scene, std::span<const SharedArray<Vec3>> frames, double exponent,
                          const insertion::Options& options, const BuildContext& context) {
  using Tree = PairTreeOf<Boxes>;
  const auto start = RunningCost::Clock::now();
  const std::vector<AlignedVector<Bvh2Node>> nodes = nodes_in_frames(bvh, scene, frames);
  Tree tree(bvh, [&nodes](std::uint32_t n) {
    typename Boxes::Doubled boxes;
    for (std::size_t f = 0; f < nodes.size(); ++f) boxes.set(f, nodes[f][n].box);
    return boxes;
  });
  FrameCosts<Tree> costs(context.cost, frames.size());
  // With exponent 0 costs have no part in the weights.
  const std::vector<double> alike(frames.size(), 1);
  const auto weigh = [&] {
    const std::vector<double>& of_frames = exponent > 0 ? costs.of(tree) : alike;
    return frame_weights(of_frames, costs.measure_roots(tree), exponent);
  };
  std::vector<float> weights = weigh();
  const auto run = [&](auto& measure, const auto& set_weights) {
    insertion::Optimization optimization(tree, measure, options, context, start);
    if (exponent > 0) {  // else they never change
      optimization.after_passes([&] {
        weights = weigh();
        set_weights();
        return true;
      });
    }
    if (optimization.run()) tree.write_to(bvh);
  };
  if (dynamic_cast<const SurfaceArea*>(context.cost.measure.get()) != nullptr) {
    insertion::FrameAreas<Boxes> areas;
    areas.set(weights);
    run(areas, [&] { areas.set(weights); });
  } else {
    insertion::FrameMeasures<Boxes> measures{context.cost.measure.get(), weights};
    run(measures, [&] { measures.weights = weights; });
  }
}

}  // namespace raystudy::tsah
