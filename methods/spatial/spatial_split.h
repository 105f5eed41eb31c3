#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/spatial/slicer.h"
#include "methods/topdown/bin_sweep.h"
#include "methods/topdown/record_passes.h"

namespace raystudy::spatial {

/// A plane through a node, and what is on either side of it: references that cross it count on both, with a part each.
struct SpatialSplit {
  std::array<WideBox, 2> boxes;
  std::array<std::uint32_t, 2> counts;
  int axis = -1;  ///< none: no plane divides the references
  float at = 0;
};

/// The measures of up to four boxes, none of them empty, through a measure that is known or not.
class BoxMeasure {
 public:
  /// `measure` must outlive it.
  explicit BoxMeasure(const Measure& measure) : measure_(&measure), surface_area_(dynamic_cast<const SurfaceArea*>(&measure)) {}

  [[nodiscard]] std::array<float, 4> operator()(const WideBox& b0, const WideBox& b1, const WideBox& b2, const WideBox& b3) const;
  [[nodiscard]] std::array<float, 2> operator()(const std::array<WideBox, 2>& boxes) const {
    const auto m = (*this)(boxes[0], boxes[1], boxes[0], boxes[1]);
    return {m[0], m[1]};
  }
  [[nodiscard]] float operator()(const WideBox& box) const { return (*this)(box, box, box, box)[0]; }
  [[nodiscard]] const Measure& measure() const { return *measure_; }
  [[nodiscard]] bool is_surface_area() const { return surface_area_ != nullptr; }

 private:
  const Measure* measure_;
  const SurfaceArea* surface_area_;  ///< measure_, if it is that
};

/// Finds the best plane between equal bins of a node's box on three axes, with references chopped at the bins' borders (Stich,
/// Friedrich and Dietrich 2009, Sec. 4.2).
class SpatialSplitter {
 public:
  SpatialSplitter(const Scene& scene, const BoxMeasure& measure, std::uint32_t bins, int threads);

  /// Of least cost among those that make `extra` more references at most and cost less than `limit`; of equal costs the first.
  [[nodiscard]] SpatialSplit split(std::span<const BoxRecord> records, const WideBox& box, std::uint32_t extra, float limit);

 private:
  /// Three rows of bins, one an axis.
  struct Bins {
    explicit Bins(std::uint32_t row)
        : begins(std::size_t{3} * row), ends(begins), parts(begins), enters(begins.size()), exits(begins.size()) {}
    std::vector<BoxRecord> begins;     ///< references that begin in the bin, whole
    std::vector<BoxRecord> ends;       ///< those that end in it, whole
    std::vector<BoxRecord> parts;      ///< what is in the bin
    std::vector<std::int32_t> enters;  ///< how many begin
    std::vector<std::int32_t> exits;   ///< how many end
  };
  struct Binning;

  void count(Bins& bins, std::span<const BoxRecord> records, const Binning& binning) const;
  void chop(Bins& bins, std::span<const BoxRecord> records, const Binning& binning, int axis) const;
  /// pass(bins, records) of all records, on several threads where they are many, for the arrays of bins that `arrays` names.
  template <class Pass, class... Arrays>
  void in_blocks(std::span<const BoxRecord> records, const Pass& pass, Arrays... arrays);
  void measure_sides(const std::vector<BoxRecord>& lefts, const std::vector<BoxRecord>& rights, std::uint32_t row);
  void consider(topdown::LeastCosts& least, std::uint32_t n, std::uint32_t extra, std::uint32_t row) const;

  const Scene& scene_;
  BoxMeasure measure_;
  std::uint32_t most_;       ///< bins an axis, at most
  std::uint32_t count_ = 0;  ///< bins an axis of the node at hand
  std::uint32_t row_ = 0;    ///< slots of a row
  int threads_;
  Bins bins_;
  std::vector<float> left_;   ///< measure of what is in a bin or before it in its row
  std::vector<float> right_;  ///< of what is in a bin or after it
};

}  // namespace raystudy::spatial
