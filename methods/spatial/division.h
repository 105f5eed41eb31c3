#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "methods/spatial/spatial_split.h"

namespace raystudy::spatial {

/// Divides a node's references at a plane. What crosses it is chopped, a part to each side, or goes to one side as a whole where
/// that costs less: reference unsplitting (Stich et al. 2009, Sec. 4.4), in the order of the references, each given what was
/// decided before.
class Division {
 public:
  Division(const Scene& scene, const BoxMeasure& measure, bool unsplitting, int threads)
      : scene_(scene), measure_(measure), unsplitting_(unsplitting), threads_(threads), blocks_(1) {}

  /// Decides where each of the records goes; how many go to either side.
  std::array<std::uint32_t, 2> decide(std::span<const BoxRecord> records, const SpatialSplit& split);
  /// Copies what `decide` was given to `left` and to `right`, in order.
  void divide(BoxRecord* left, BoxRecord* right) const;

 private:
  struct Crossing {
    std::size_t at;                ///< which record of its block
    std::array<bool, 2> goes{};    ///< to which sides
    std::array<WideBox, 2> boxes;  ///< on each side
  };
  struct Block {
    std::span<const BoxRecord> records;
    std::array<std::uint32_t, 2> counts{};
    std::vector<Crossing> crossings;
  };

  void classify(std::span<const BoxRecord> records, Block& block) const;
  void unsplit(SpatialSplit& sides, const WideBox& whole, Crossing& crossing) const;
  void divide(const Block& block, BoxRecord* left, BoxRecord* right) const;

  const Scene& scene_;
  BoxMeasure measure_;
  bool unsplitting_;
  int threads_;
  int axis_ = 0;
  float at_ = 0;
  std::vector<Block> blocks_;
};

}  // namespace raystudy::spatial
