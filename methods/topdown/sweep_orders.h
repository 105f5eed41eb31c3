#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "harness/scene/scene.h"
#include "methods/topdown/box_record.h"

namespace raystudy::topdown {

/// Which number of a triangle puts it into order along an axis.
enum class Positions : std::uint8_t {
  box_centers,  ///< (lower + upper) / 2 of its box
  centroids,    ///< the mean of its vertices
  box_bounds    ///< two orders an axis: by lower and by upper bound
};

/// The boxes of a scene's triangles, and their indices sorted by every position of every axis, equal ones by index.
struct SweepOrders {
  /// Works in the calling thread's arena; `threads` 1 keeps to the calling thread. `meanwhile` is called once, beside the
  /// sorting.
  SweepOrders(const Scene& scene, Positions positions, int threads, const std::function<void()>& meanwhile);

  [[nodiscard]] int count() const { return static_cast<int>(lists.size()); }
  [[nodiscard]] int first_of_axis(int axis) const { return axis * count() / 3; }

  BoxRecords records;                                   ///< by triangle
  std::vector<std::unique_ptr<std::uint32_t[]>> lists;  ///< axis by axis; with box_bounds, lower before upper
};

/// Fills `records`, one a triangle, in the scene's order.
void fill_records(const Scene& scene, int threads, std::span<BoxRecord> records);

}  // namespace raystudy::topdown
