#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/topdown/box_record.h"

namespace raystudy::topdown {

/// A split between two neighbouring bins. Bins stand in three rows, one an axis, which are filled up with empty bins to a
/// multiple of four.
struct BinChoice {
  int axis = -1;          ///< none: no split tells the triangles apart
  std::int32_t bin = 0;   ///< the first of the right side
  std::int32_t left = 0;  ///< triangles of the left side
};

/// `left` and the sums of it with one, two, three and four of the counts.
[[nodiscard]] inline hn::Vec<Int4> running_sums(hn::Vec<Int4> left, const std::int32_t* counts) {
  const Int4 di;
  auto sums = hn::LoadU(di, counts);
  sums = hn::Add(sums, hn::ShiftLeftLanes<1>(di, sums));
  sums = hn::Add(sums, hn::ShiftLeftLanes<2>(di, sums));
  return hn::Add(left, sums);
}

/// The unions of the bins of a row before `bin` and of the others.
[[nodiscard]] inline std::array<WideBox, 2> bin_sides(const BoxRecord* boxes, std::uint32_t row, std::uint32_t bin) {
  std::array<WideBox, 2> sides{WideBox::empty(), WideBox::empty()};
  for (std::uint32_t i = 0; i < bin; ++i) sides[0] = united(sides[0], WideBox::of(boxes[i]));
  for (std::uint32_t i = bin; i < row; ++i) sides[1] = united(sides[1], WideBox::of(boxes[i]));
  return sides;
}

/// The least cost so far in each of four lanes; of equal costs the first.
struct LeastCosts {
  hn::Vec<Float4> cost = hn::Set(Float4(), std::numeric_limits<float>::infinity());
  hn::Vec<Int4> at = hn::Zero(Int4());    ///< the bin before the split, by index into the rows
  hn::Vec<Int4> left = hn::Zero(Int4());  ///< triangles of the left side

  /// Takes in the splits after bins `first` to `first + 3`; `lefts` and `rights` are the triangles on either side.
  void consider(std::uint32_t first, hn::Vec<Float4> left_measures, hn::Vec<Float4> right_measures, hn::Vec<Int4> lefts,
                hn::Vec<Int4> rights) {
    const Float4 d;
    const Int4 di;
    const auto c = hn::Add(hn::Mul(left_measures, hn::ConvertTo(d, lefts)), hn::Mul(right_measures, hn::ConvertTo(d, rights)));
    const auto some = hn::And(hn::Gt(lefts, hn::Zero(di)), hn::Gt(rights, hn::Zero(di)));
    const auto less = hn::And(hn::Lt(c, cost), hn::RebindMask(d, some));
    const auto less_i = hn::RebindMask(di, less);
    cost = hn::IfThenElse(less, c, cost);
    at = hn::IfThenElse(less_i, hn::Iota(di, static_cast<std::int32_t>(first)), at);
    left = hn::IfThenElse(less_i, lefts, left);
  }

  [[nodiscard]] bool is_below(float limit) const { return !hn::AllFalse(Float4(), hn::Lt(cost, hn::Set(Float4(), limit))); }

  /// The least of all, of rows of `row` bins.
  [[nodiscard]] BinChoice choice(std::uint32_t row) const {
    const auto costs = std::bit_cast<std::array<float, 4>>(cost);
    const auto ats = std::bit_cast<std::array<std::uint32_t, 4>>(at);
    std::size_t best = 0;
    for (std::size_t i = 1; i < 4; ++i) {
      const bool better = (costs[i] < costs[best]) | ((costs[i] == costs[best]) & (ats[i] < ats[best]));
      best = better ? i : best;
    }
    if (!(costs[best] < std::numeric_limits<float>::infinity())) return {};
    const int axis = (ats[best] >= row ? 1 : 0) + (ats[best] >= 2 * row ? 1 : 0);
    return {axis, static_cast<std::int32_t>(ats[best] - static_cast<std::uint32_t>(axis) * row) + 1,
            std::bit_cast<std::array<std::int32_t, 4>>(left)[best]};
  }
};

/// Three rows of bins, of `row` slots each.
struct BinRows {
  const BoxRecord* boxes;
  const std::int32_t* counts;
  std::uint32_t row;
};

/// Looks for the best split between bins: that of least m(L) · n_L + m(R) · n_R, of equal ones the first.
class BinSweep {
 public:
  /// Of rows of up to `bins` bins, filled up or not. `measure` must outlive the sweep.
  BinSweep(const Measure& measure, std::uint32_t bins);

  /// `n`: triangles of a row.
  [[nodiscard]] BinChoice best(const BinRows& bins, std::int32_t n) {
    return surface_area_ ? by_area(bins, n) : by_measure(bins, n);
  }

 private:
  [[nodiscard]] BinChoice by_area(const BinRows& bins, std::int32_t n);
  [[nodiscard]] BinChoice by_measure(const BinRows& bins, std::int32_t n);

  const Measure* measure_;
  bool surface_area_;
  std::vector<float> right_;  ///< measure of a bin united with those after it in its row
};

}  // namespace raystudy::topdown
