#include "methods/topdown/bin_sweep.h"

#include <span>

namespace raystudy::topdown {

BinSweep::BinSweep(const Measure& measure, std::uint32_t bins)
    : measure_(&measure),
      surface_area_(dynamic_cast<const SurfaceArea*>(&measure) != nullptr),
      right_(std::size_t{3} * ((bins + 3) / 4 * 4) + 1) {}

BinChoice BinSweep::by_area(const BinRows& bins, std::int32_t n) {
  const Float4 d;
  const Int4 di;
  const BoxRecord* boxes = bins.boxes;
  const std::int32_t* counts = bins.counts;
  float* rights = right_.data();
  const auto bin = [&](std::uint32_t i) { return WideBox::of(boxes[i]); };
  LeastCosts least;
  const std::uint32_t row_size = bins.row;
  for (std::uint32_t row = 0; row < 3 * row_size; row += row_size) {
    WideBox right = WideBox::empty();
    for (std::uint32_t i = row + row_size; i > row; i -= 4) {
      hn::StoreU(grow<true>(right, bin(i - 1), bin(i - 2), bin(i - 3), bin(i - 4)), d, &rights[i - 4]);
    }
    WideBox left = WideBox::empty();
    auto left_count = hn::Zero(di);
    for (std::uint32_t i = row; i < row + row_size; i += 4) {
      const auto lefts = running_sums(left_count, counts + i);
      left_count = hn::Broadcast<3>(lefts);
      const auto measures = grow<false>(left, bin(i), bin(i + 1), bin(i + 2), bin(i + 3));
      least.consider(i, measures, hn::LoadU(d, &rights[i + 1]), lefts, hn::Sub(hn::Set(di, n), lefts));
    }
  }
  return least.choice(row_size);
}

BinChoice BinSweep::by_measure(const BinRows& bins, std::int32_t n) {
  const Float4 d;
  const Int4 di;
  const std::uint32_t size = 3 * bins.row;
  std::vector<Box> lefts(size);
  std::vector<Box> rights(size);
  for (std::uint32_t row = 0; row < size; row += bins.row) {
    WideBox left = WideBox::empty();
    WideBox right = WideBox::empty();
    for (std::uint32_t i = 0; i < bins.row; ++i) {
      left = united(left, WideBox::of(bins.boxes[row + i]));
      lefts[row + i] = left.box();
      right = united(right, WideBox::of(bins.boxes[row + bins.row - 1 - i]));
      rights[row + bins.row - 1 - i] = right.box();
    }
  }
  std::vector<float> left_measures(size);
  measure_->evaluate(lefts, left_measures);
  measure_->evaluate(rights, std::span(right_).first(size));
  LeastCosts least;
  for (std::uint32_t row = 0; row < size; row += bins.row) {
    auto left_count = hn::Zero(di);
    for (std::uint32_t i = row; i < row + bins.row; i += 4) {
      const auto counts = running_sums(left_count, &bins.counts[i]);
      left_count = hn::Broadcast<3>(counts);
      least.consider(i, hn::LoadU(d, &left_measures[i]), hn::LoadU(d, &right_[i + 1]), counts, hn::Sub(hn::Set(di, n), counts));
    }
  }
  return least.choice(bins.row);
}

}  // namespace raystudy::topdown
