#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "harness/geometry/box.h"
#include "harness/scene/scene.h"
#include "methods/topdown/box_record.h"

namespace raystudy::spatial {

/// The spatial median planes of a scene: on each axis the one that halves its box (level 0), those that halve the halves (level
/// 1), and so on. The lower the level, the more important the plane.
class MedianPlanes {
 public:
  static constexpr int levels = 24;  ///< finer planes are no longer told apart by floats
  struct Plane {
    int axis = -1;  ///< none
    int level = 0;
    float at = 0;
  };

  explicit MedianPlanes(const Box& scene);

  /// The most important plane that runs through the inside of the box, which lies in the scene's; of several on as many axes the
  /// one across the box's longest extent.
  [[nodiscard]] Plane most_important(const Box& box) const;
  /// Of the scene's box, in square scene units.
  [[nodiscard]] double surface_area() const { return surface_area_; }

 private:
  std::array<double, 3> lower_;
  std::array<double, 3> cell_;      ///< extent between the planes of the last level
  std::array<double, 3> per_unit_;  ///< 1 / cell_; 0 where the scene has no extent
  double surface_area_;
};

/// How much there is to gain by splitting a triangle whose box is `record`: p = (X · (A_box - A_ideal))^(1/3), where X = 2^-level
/// of its most important plane, A_box is the box's surface area and A_ideal what is left of it when the triangle is split ever
/// finer, the sum of the absolute components of the cross product of two edges. Areas are relative to the scene's, which keeps
/// them in a float's range. 0 where no plane crosses the box (Karras and Aila 2013, Sec. on triangle splitting).
[[nodiscard]] float split_priority(const Scene& scene, const MedianPlanes& planes, const topdown::BoxRecord& record);

/// floor(scale · priority), up to 2^30.
[[nodiscard]] inline std::uint32_t split_count(float scale, float priority) {
  const float splits = scale * priority;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(splits < 0x1p30F ? splits : 0x1p30F));
}

/// A scale by which all split counts together meet `budget`, or the largest by which they do not exceed it.
[[nodiscard]] float split_scale(std::span<const float> priorities, std::uint64_t budget, int threads);

/// The boxes of a scene's triangles, of which those of high priority are split into several, each over a part of the triangle:
/// at the most important plane of the part's box, where either side gets its share of the splits that are left by its longest
/// extent. Together they hold all of the triangle whatever rounding does. In order of triangles, whatever the threads.
class PresplitRecords {
 public:
  /// Up to `budget` · n boxes are added to those of the n triangles.
  PresplitRecords(const Scene& scene, double budget, int threads);

  [[nodiscard]] std::span<topdown::BoxRecord> records() { return {room_.data(), count_}; }

 private:
  void split(const Scene& scene, std::uint64_t budget, int threads);

  topdown::BoxRecords room_;
  std::size_t count_;
};

}  // namespace raystudy::spatial
