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

  std::uint32_t split(std::span<BoxRecord> records, const NodeBounds& bounds);

 private:
  /// Three rows of bins, one an axis; a row is filled up with empty bins to a multiple of four.
  struct Bins {
    explicit Bins(std::uint32_t row) : boxes(std::size_t{3} * row), counts(std::size_t{3} * row) {}
    void clear(std::uint32_t row);
    void merge(const Bins& other, std::uint32_t row);
    std::vector<BoxRecord> boxes;
    std::vector<std::uint32_t> counts;
  };

  /// From a triangle's box to its bins, by index into Bins.
  class Binning {
   public:
    Binning(const NodeBounds& bounds, std::uint32_t bins, std::uint32_t row);
    [[nodiscard]] hn::Vec<Int4> operator()(const WideBox& box) const {
      const auto at = hn::ConvertTo(Int4(), hn::Mul(hn::Sub(doubled_center(box), origin_), scale_));
      // The bounds also hold what is not a number, of boxes too large for floats to have a center.
      return hn::Add(hn::Min(hn::Max(at, hn::Zero(Int4())), last_), row_);
    }

   private:
    hn::Vec<Float4> origin_;
    hn::Vec<Float4> scale_;
    hn::Vec<Int4> last_;
    hn::Vec<Int4> row_;
  };

  struct Choice {
    float cost = std::numeric_limits<float>::infinity();
    int axis = -1;
    std::int32_t bin = 0;  ///< the first of the right side, by index into Bins
  };

  static void fill(Bins& bins, std::span<const BoxRecord> records, const Binning& binning);
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
