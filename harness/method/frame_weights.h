#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/base/shared_array.h"
#include "harness/method/cost_model.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What a node's measure in each frame counts in the cost of a whole animation (Bittner and Meister 2015, Eq. 2 and 3). The frame
/// cost C_i divides by the root's measure S_i, so that the frame's weight w_i = C_i^k becomes w_i / S_i for a node. Scaled so
/// that the largest is 1: one frame alone has weight 1, and counts as it does without frames. A root of measure 0 counts as 1.
[[nodiscard]] std::vector<float> frame_weights(std::span<const double> costs, std::span<const double> root_measures,
                                               double exponent);

/// A tree's boxes in every frame: the nodes of `bvh` refitted to each.
[[nodiscard]] std::vector<AlignedVector<Bvh2Node>> nodes_in_frames(const Bvh2& bvh, const Scene& scene,
                                                                   std::span<const SharedArray<Vec3>> frames);

/// Σ_i ω_i m(N(t_i)) for every node of `bvh`, with frame_weights of the costs that it has in the frames now.
[[nodiscard]] std::vector<float> weighted_measures(const Bvh2& bvh, const Scene& scene, std::span<const SharedArray<Vec3>> frames,
                                                   double exponent, const CostModel& model);

/// C~^k of a tree (Eq. 3): Σ C_i^(k+1) / Σ C_i^k over its costs in the frames.
[[nodiscard]] double animation_cost(std::span<const double> costs, double exponent);

}  // namespace raystudy
