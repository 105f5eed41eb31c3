#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// A cut through a tree: its topmost nodes of less than `triangles` triangles, and larger leaves. Gives each triangle of the
/// scene the number of the node it is in, depth first from 0 (Bittner and Meister 2015, Fig. 2); one in several leaves has the
/// last.
[[nodiscard]] std::vector<std::uint32_t> clusters_of(const Bvh2& bvh, std::uint32_t triangles);

/// A colour for each cluster such that neighbours in number differ: hues a golden section of the circle apart. Linear RGB.
[[nodiscard]] Vec3 cluster_color(std::uint32_t cluster);

/// `frame` with every triangle in the colour of its cluster and nothing that shines, mirrors or refracts.
[[nodiscard]] Scene colored_by_cluster(const Scene& frame, const std::vector<std::uint32_t>& clusters);

}  // namespace raystudy
