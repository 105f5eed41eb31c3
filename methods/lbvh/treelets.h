#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/lbvh/hierarchy.h"

namespace raystudy::lbvh {

/// A treelet under a tree over treelets.
struct Treelet {
  Box box;
  Vec3 center;
  std::uint32_t triangles;
  std::uint32_t leaves;
  std::uint32_t number;  ///< in Morton order
  std::uint16_t bins[3];
};

/// Splits nodes over treelets between bins (README.md, 7).
class TreeletSplitter {
 public:
  /// `measure` must outlive the splitter.
  TreeletSplitter(const Measure& measure, std::uint32_t bins);

  /// Puts those of the left child in front; either side keeps its order. Returns how many they are, of two treelets or more.
  /// `scratch` has room for as many.
  [[nodiscard]] std::size_t split(std::span<Treelet> treelets, std::span<Treelet> scratch);

 private:
  /// The first bin of the right side, on an axis; -1: no split counts.
  struct Choice {
    int axis = -1;
    std::uint32_t bin = 0;
  };

  void fill(std::span<Treelet> treelets);
  [[nodiscard]] Choice best();

  const Measure& measure_;
  std::uint32_t bins_;
  // Three rows of bins, one an axis, and of the splits behind all bins but the last the boxes and numbers of either side.
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> triangles_;
  std::vector<Box> sides_;
  std::vector<float> measures_;
  std::vector<std::uint32_t> before_;
};

/// Where a treelet goes in the finished tree: the numbers of its first leaf and of its first triangle.
struct TreeletPlace {
  std::uint32_t leaf;
  std::uint32_t triangle;
};

/// Builds the tree over treelets: writes its nodes to `nodes`, the treelets' roots included, and returns where the treelets go.
[[nodiscard]] std::vector<TreeletPlace> build_over_treelets(std::span<const Part> roots, const Measure& measure,
                                                            std::uint32_t bins, int threads, Bvh2Node* nodes);

}  // namespace raystudy::lbvh
