#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/lbvh/hierarchy.h"
#include "methods/topdown/bin_sweep.h"

namespace raystudy::lbvh {

/// A treelet under a tree over treelets.
struct Treelet {
  WideBox box;
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
  /// Returns the number of triangles.
  std::int32_t fill(std::span<Treelet> treelets);

  std::uint32_t bins_;
  std::uint32_t row_;
  topdown::BoxRecords boxes_;
  std::vector<std::int32_t> counts_;  ///< of triangles
  topdown::BinSweep sweep_;
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
