#pragma once

#include <memory>

#include "harness/method/method.h"
#include "methods/topdown/top_down.h"

namespace raystudy::spatial {

/// What a build with spatial splits goes by.
struct SpatialPolicy {
  std::uint32_t bins = 32;          ///< of box centers, an axis, at most
  std::uint32_t spatial_bins = 16;  ///< of space, an axis, at most
  float alpha = 1e-5F;              ///< spatial splits are tried where the sides overlap by more, as a share of m(root)
  double budget = 0.2;              ///< references more than triangles, at most, as a share of the triangles
  bool unsplitting = true;
};

/// Top-down construction by object splits and spatial splits (Stich, Friedrich and Dietrich 2009).
[[nodiscard]] std::unique_ptr<Bvh2> build_with_spatial_splits(const Scene& scene, const BuildContext& context,
                                                              const SpatialPolicy& policy, const topdown::LeafPolicy& leaves,
                                                              const Measure& measure);

}  // namespace raystudy::spatial
