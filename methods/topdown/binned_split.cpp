#include "methods/topdown/binned_split.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>

namespace raystudy::topdown {

BinnedSplitter::BinnedSplitter(const Measure& measure, std::uint32_t bins, int threads)
    : measure_(&measure),
      surface_area_(dynamic_cast<const SurfaceArea*>(&measure) != nullptr),
      count_(bins),
      row_((bins + 3) / 4 * 4),
      threads_(threads),
      bins_(row_),
      left_(bins_.boxes.size()),
      right_(bins_.boxes.size()) {}

void BinnedSplitter::Bins::clear() {
  const Float4 d;
  const WideBox empty = WideBox::empty();
  for (BoxRecord& box : boxes) {
    auto* p = reinterpret_cast<float*>(&box);
    hn::Store(empty.lower, d, p);
    hn::Store(empty.upper, d, p + 4);
  }
  std::fill(counts.begin(), counts.end(), 0);
}

void BinnedSplitter::Bins::merge(const Bins& other) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const WideBox box = united(WideBox::of(boxes[i]), WideBox::of(other.boxes[i]));
    auto* p = reinterpret_cast<float*>(&boxes[i]);
    hn::Store(box.lower, Float4(), p);
    hn::Store(box.upper, Float4(), p + 4);
    counts[i] += other.counts[i];
  }
}

BinnedSplitter::Binning::Binning(const NodeBounds& bounds, std::uint32_t bins, std::uint32_t row)
    : origin_(bounds.centers.lower), last_(hn::Set(Int4(), static_cast<std::int32_t>(bins) - 1)) {
  const Float4 d;
  const auto extent = hn::Sub(bounds.centers.upper, bounds.centers.lower);
  const auto some = hn::Gt(extent, hn::Zero(d));
  scale_ = hn::IfThenElseZero(some, hn::Div(hn::Set(d, static_cast<float>(bins)), extent));
  row_ = hn::Mul(hn::Iota(Int4(), 0), hn::Set(Int4(), static_cast<std::int32_t>(row)));
}

void BinnedSplitter::fill(Bins& bins, std::span<const BoxRecord> records, const Binning& binning) {
  const Float4 d;
  alignas(16) std::int32_t at[4];
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    hn::Store(binning(box), Int4(), at);
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(at[axis]);
      auto* p = reinterpret_cast<float*>(&bins.boxes[i]);
      hn::Store(hn::Min(hn::Load(d, p), box.lower), d, p);
      hn::Store(hn::Max(hn::Load(d, p + 4), box.upper), d, p + 4);
      ++bins.counts[i];
    }
  }
}

void BinnedSplitter::fill_shared(std::span<const BoxRecord> records, const Binning& binning) {
  Bins empty(row_);
  empty.clear();
  bins_ = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, records.size(), shared_pass / 4), empty,
      [&](const auto& range, Bins bins) {
        fill(bins, records.subspan(range.begin(), range.size()), binning);
        return bins;
      },
      [](Bins a, const Bins& b) {
        a.merge(b);
        return a;
      });
}

void BinnedSplitter::measure_sides() {
  const Float4 d;
  if (surface_area_) {
    for (std::uint32_t row = 0; row < 3 * row_; row += row_) {
      WideBox left = WideBox::empty();
      WideBox right = WideBox::empty();
      const auto bin = [&](std::uint32_t i) { return WideBox::of(bins_.boxes[i]); };
      for (std::uint32_t i = row; i < row + row_; i += 4) {
        hn::StoreU(grow<false>(left, bin(i), bin(i + 1), bin(i + 2), bin(i + 3)), d, &left_[i]);
      }
      for (std::uint32_t i = row + row_; i > row; i -= 4) {
        hn::StoreU(grow<true>(right, bin(i - 1), bin(i - 2), bin(i - 3), bin(i - 4)), d, &right_[i - 4]);
      }
    }
    return;
  }
  std::vector<Box> lefts(left_.size());
  std::vector<Box> rights(right_.size());
  for (std::uint32_t row = 0; row < 3 * row_; row += row_) {
    WideBox left = WideBox::empty();
    WideBox right = WideBox::empty();
    for (std::uint32_t i = 0; i < row_; ++i) {
      left = united(left, WideBox::of(bins_.boxes[row + i]));
      lefts[row + i] = left.box();
      right = united(right, WideBox::of(bins_.boxes[row + row_ - 1 - i]));
      rights[row + row_ - 1 - i] = right.box();
    }
  }
  measure_->evaluate(lefts, left_);
  measure_->evaluate(rights, right_);
}

BinnedSplitter::Choice BinnedSplitter::best_choice(std::uint32_t n) const {
  Choice best;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t row = static_cast<std::uint32_t>(axis) * row_;
    std::uint32_t left = 0;
    for (std::uint32_t i = row + 1; i < row + count_; ++i) {
      left += bins_.counts[i - 1];
      if (left == 0) continue;
      if (left == n) break;
      const float cost = left_[i - 1] * static_cast<float>(left) + right_[i] * static_cast<float>(n - left);
      if (cost < best.cost) best = {cost, axis, i};
    }
  }
  return best;
}

std::uint32_t BinnedSplitter::split(std::span<BoxRecord> records, const NodeBounds& bounds) {
  const Binning binning(bounds, count_, row_);
  if (threads_ > 1 && records.size() >= shared_pass) {
    fill_shared(records, binning);
  } else {
    bins_.clear();
    fill(bins_, records, binning);
  }
  measure_sides();
  const auto n = static_cast<std::uint32_t>(records.size());
  const Choice choice = best_choice(n);
  if (choice.axis < 0) return split_at_median(records, bounds.box.box().longest_axis());
  return partition_records(records, [&](const BoxRecord& record) {
    alignas(16) std::int32_t at[4];
    hn::Store(binning(WideBox::of(record)), Int4(), at);
    return at[choice.axis] < static_cast<std::int32_t>(choice.bin);
  });
}

}  // namespace raystudy::topdown
