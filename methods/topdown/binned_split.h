#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/topdown/bin_sweep.h"
#include "methods/topdown/record_build.h"

namespace raystudy::topdown {

/// The parameters of a builder by BinnedSplitter: `bins`, `heuristic` and those of LeafPolicy.
[[nodiscard]] std::vector<ParamSpec> binned_params();

/// Splits between equal bins of the box centers on three axes (Wald 2007, Sec. 3): of the splits between two neighbouring bins
/// the one of least cost is taken; of equal costs the first. Nodes of few triangles have fewer bins, 4 + n / 4. Where all centers
/// fall into one bin on every axis, the object median along the longest axis of the node's box takes its place.
class BinnedSplitter {
 public:
  static constexpr std::uint32_t few = FewBoxes::most;

  /// `measure` must outlive the splitter.
  BinnedSplitter(const Measure& measure, std::uint32_t bins, int threads);

  [[nodiscard]] Split split(std::span<const BoxRecord> records, const NodeBounds& bounds);
  /// The union of the boxes on either side of the plane that `split` has just found.
  [[nodiscard]] std::array<WideBox, 2> sides(const Plane& plane) const;
  [[nodiscard]] FewSet split_few(const FewBoxes& boxes, FewSet set) const;

 private:
  /// Three rows of bins, one an axis; a row is filled up with empty bins to a multiple of four.
  struct Bins {
    explicit Bins(std::uint32_t row) : boxes(std::size_t{3} * row), counts(std::size_t{3} * row) {}
    void clear(std::uint32_t row);
    void merge(const Bins& other, std::uint32_t row);
    std::vector<BoxRecord> boxes;
    std::vector<std::int32_t> counts;
  };

  /// ConvertTo without the mending of what is out of an integer's range.
  [[nodiscard]] static hn::Vec<Int4> truncated(hn::Vec<Float4> v) {
    using Floats = float __attribute__((vector_size(16)));
    using Ints = std::int32_t __attribute__((vector_size(16)));
    return std::bit_cast<hn::Vec<Int4>>(__builtin_convertvector(std::bit_cast<Floats>(v), Ints));
  }

  /// From a triangle's box to its bin on each axis.
  struct Binning {
    Binning(const NodeBounds& bounds, std::uint32_t bins, std::uint32_t row);
    /// Where between the bins the center lies: bin i is [i, i + 1), apart from the last, which holds what is not less.
    [[nodiscard]] hn::Vec<Float4> place(const WideBox& box) const { return hn::Mul(hn::Sub(doubled_center(box), origin), scale); }
    [[nodiscard]] hn::Vec<Int4> operator()(const WideBox& box) const {
      // The minimum also holds what is not a number, of boxes too large for floats to have a center.
      return hn::Add(hn::ShiftLeft<2>(truncated(hn::Min(place(box), last))), row);
    }
    /// The plane between the bins before `bin`, which is not the first, and the others.
    [[nodiscard]] Plane plane(int axis, std::int32_t bin) const;

    hn::Vec<Float4> origin;
    hn::Vec<Float4> scale;
    hn::Vec<Float4> last;
    hn::Vec<Int4> row;
  };

  static void fill(Bins& bins, std::span<const BoxRecord> records, const Binning& binning);
  void fill_alternating(std::span<const BoxRecord> records, const Binning& binning);
  void fill_shared(std::span<const BoxRecord> records, const Binning& binning);

  std::uint32_t most_;       ///< bins an axis, at most
  std::uint32_t count_ = 0;  ///< bins an axis of the node at hand
  std::uint32_t row_ = 0;    ///< slots of a row
  int threads_;
  Bins bins_;
  Bins odd_;  ///< of every other triangle of a node of many
  BinSweep sweep_;
};

}  // namespace raystudy::topdown
