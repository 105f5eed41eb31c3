#pragma once

#include <cstddef>
#include <vector>

#include "harness/accel/bvh2.h"

namespace raystudy::updates {

/// How far refitting has worn out a tree (Lauterbach 2010, Sec. 4.1.5). An inner node's ratio is its surface area over the sum of
/// its children's; the measure is the mean over all inner nodes of the ratio now minus the ratio as built. Nodes that have become
/// better count with their sign, as in the thesis. A node whose children had or have no area has no ratio and adds nothing.
class Degradation {
 public:
  /// Takes the ratios of `bvh` as it is.
  Degradation(const Bvh2& bvh, int threads);

  /// The measure of the same tree with other boxes; 0 where it has no inner node. The same whatever the threads.
  [[nodiscard]] double of(const Bvh2& bvh) const;

  [[nodiscard]] std::size_t bytes() const { return ratios_.size() * sizeof(float); }

 private:
  int threads_;
  std::vector<float> ratios_;  ///< of the node above each pair of siblings; negative: none
};

}  // namespace raystudy::updates
