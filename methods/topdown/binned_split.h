#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/topdown/record_build.h"

namespace raystudy::topdown {

/// Splits between equal bins of the box centers on three axes (Wald 2007, Sec. 3): of the splits between two neighbouring bins
/// the one of least cost is taken; of equal costs the first. Where all centers fall into one bin on every axis, the object median
/// along the longest axis of the node's box takes its place.
class BinnedSplitter {
 public:
  /// `measure` must outlive the splitter.
  BinnedSplitter(const Measure& measure, std::uint32_t bins, int threads);

  Division split(std::span<BoxRecord> records, BoxRecord* spare, const NodeBounds& bounds);

 private:
  /// Three rows of bins, one an axis; a row is filled up with empty bins to a multiple of four.
  struct Bins {
    explicit Bins(std::uint32_t row) : boxes(std::size_t{3} * row), counts(std::size_t{3} * row) {}
    void clear(std::uint32_t row);
    void merge(const Bins& other, std::uint32_t row);
    std::vector<BoxRecord> boxes;
    std::vector<std::int32_t> counts;
  };

  /// From a triangle's box to its bin on each axis.
  struct Binning {
    Binning(const NodeBounds& bounds, std::uint32_t bins);
    [[nodiscard]] hn::Vec<Int4> operator()(const WideBox& box) const {
      // The minimum also holds what is not a number, of boxes too large for floats to have a center.
      return hn::ConvertTo(Int4(), hn::Min(hn::Mul(hn::Sub(doubled_center(box), origin), scale), last));
    }
    /// The same on one axis.
    struct OnAxis {
      int axis;
      float origin;
      float scale;
      float last;
      [[nodiscard]] std::int32_t operator()(const BoxRecord& record) const {
        const float at = (doubled_center(record, axis) - origin) * scale;
        return static_cast<std::int32_t>(at < last ? at : last);
      }
    };
    [[nodiscard]] OnAxis on_axis(int axis) const;

    hn::Vec<Float4> origin;
    hn::Vec<Float4> scale;
    hn::Vec<Float4> last;
  };

  struct Choice {
    int axis = -1;          ///< none: no split tells the triangles apart
    std::int32_t bin = 0;   ///< the first of the right side
    std::int32_t left = 0;  ///< triangles of the left side
  };

  static void fill(Bins& bins, std::uint32_t row, std::span<const BoxRecord> records, const Binning& binning);
  void fill_alternating(std::span<const BoxRecord> records, const Binning& binning);
  void fill_shared(std::span<const BoxRecord> records, const Binning& binning);
  void measure_sides();
  [[nodiscard]] Choice best_choice(std::int32_t n) const;

  const Measure* measure_;
  bool surface_area_;
  std::uint32_t most_;       ///< bins an axis, at most
  std::uint32_t count_ = 0;  ///< bins an axis of the node at hand
  std::uint32_t row_ = 0;    ///< slots of a row
  int threads_;
  Bins bins_;
  Bins odd_;                  ///< of every other triangle of a node of many
  std::vector<float> left_;   ///< measure of a bin united with those before it in its row
  std::vector<float> right_;  ///< and with those after it
};

}  // namespace raystudy::topdown
