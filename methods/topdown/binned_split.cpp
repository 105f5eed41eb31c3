#include "methods/topdown/binned_split.h"

#include <algorithm>

namespace raystudy::topdown {

BinnedSplitter::BinnedSplitter(const Measure& measure, std::uint32_t bins, int threads)
    : measure_(&measure),
      surface_area_(dynamic_cast<const SurfaceArea*>(&measure) != nullptr),
      most_(bins),
      threads_(threads),
      bins_((bins + 3) / 4 * 4),
      odd_((bins + 3) / 4 * 4),
      left_(bins_.boxes.size()),
      right_(bins_.boxes.size()) {}

void BinnedSplitter::Bins::clear(std::uint32_t row) {
  const Float4 d;
  const WideBox empty = WideBox::empty();
  for (std::size_t i = 0; i < std::size_t{3} * row; ++i) {
    auto* p = reinterpret_cast<float*>(&boxes[i]);
    hn::Store(empty.lower, d, p);
    hn::Store(empty.upper, d, p + 4);
  }
  std::fill_n(counts.begin(), std::size_t{3} * row, 0);
}

void BinnedSplitter::Bins::merge(const Bins& other, std::uint32_t row) {
  for (std::size_t i = 0; i < std::size_t{3} * row; ++i) {
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

namespace {

/// Pointers of their own: of vectors behind a reference the compiler would have to fear that a store changes them.
struct BinPointers {
  BoxRecord* boxes;
  std::uint32_t* counts;

  void add(const WideBox& box, hn::Vec<Int4> bins) const {
    const Float4 d;
    alignas(16) std::int32_t at[4];
    hn::Store(bins, Int4(), at);
    for (int axis = 0; axis < 3; ++axis) {
      auto* p = reinterpret_cast<float*>(boxes + at[axis]);
      hn::Store(hn::Min(hn::Load(d, p), box.lower), d, p);
      hn::Store(hn::Max(hn::Load(d, p + 4), box.upper), d, p + 4);
      ++counts[at[axis]];
    }
  }
};

}  // namespace

void BinnedSplitter::fill(Bins& bins, std::span<const BoxRecord> records, const Binning& by_value) {
  const BinPointers to{bins.boxes.data(), bins.counts.data()};
  const Binning binning = by_value;
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    to.add(box, binning(box));
  }
}

void BinnedSplitter::fill_alternating(std::span<const BoxRecord> records, const Binning& by_value) {
  // Neighbours often share a bin, and the second then waits for the first's stores; with two sets of bins it does not.
  const BinPointers even{bins_.boxes.data(), bins_.counts.data()};
  const BinPointers odd{odd_.boxes.data(), odd_.counts.data()};
  const Binning binning = by_value;
  odd_.clear(row_);
  std::size_t i = 0;
  for (; i + 1 < records.size(); i += 2) {
    const WideBox a = WideBox::of(records[i]);
    const WideBox b = WideBox::of(records[i + 1]);
    even.add(a, binning(a));
    odd.add(b, binning(b));
  }
  fill(bins_, records.subspan(i), binning);
  bins_.merge(odd_, row_);
}

void BinnedSplitter::fill_shared(std::span<const BoxRecord> records, const Binning& binning) {
  const auto parts = pass_in_blocks(records, threads_, [&](std::span<const BoxRecord> part) {
    auto bins = std::make_unique<Bins>(row_);
    bins->clear(row_);
    fill(*bins, part, binning);
    return bins;
  });
  bins_.clear(row_);
  for (const auto& part : parts) bins_.merge(*part, row_);
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
  std::vector<Box> lefts(std::size_t{3} * row_);
  std::vector<Box> rights(lefts.size());
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
  measure_->evaluate(lefts, std::span(left_).first(lefts.size()));
  measure_->evaluate(rights, std::span(right_).first(rights.size()));
}

BinnedSplitter::Choice BinnedSplitter::best_choice(std::int32_t n) const {
  Choice best;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t row = static_cast<std::size_t>(axis) * row_;
    const std::uint32_t* counts = &bins_.counts[row];
    const float* lefts = &left_[row];
    const float* rights = &right_[row];
    std::int32_t left = 0;
    for (std::uint32_t i = 1; i < count_; ++i) {
      left += static_cast<std::int32_t>(counts[i - 1]);
      const std::int32_t right = n - left;
      // One side is empty: 0 times the measure of the empty box is no cost.
      const float cost = lefts[i - 1] * static_cast<float>(left) + rights[i] * static_cast<float>(right);
      const bool better = (cost < best.cost) & (left > 0) & (right > 0);
      best.cost = better ? cost : best.cost;
      best.axis = better ? axis : best.axis;
      best.bin = better ? static_cast<std::int32_t>(row + i) : best.bin;
    }
  }
  return best;
}

std::uint32_t BinnedSplitter::split(std::span<BoxRecord> records, const NodeBounds& bounds) {
  const auto n = static_cast<std::uint32_t>(records.size());
  count_ = std::min(most_, std::max(n, 4U));
  row_ = (count_ + 3) / 4 * 4;
  const Binning binning(bounds, count_, row_);
  if (threads_ > 1 && records.size() >= shared_pass) {
    fill_shared(records, binning);
  } else {
    bins_.clear(row_);
    if (n >= 128) {
      fill_alternating(records, binning);
    } else {
      fill(bins_, records, binning);
    }
  }
  measure_sides();
  const Choice choice = best_choice(static_cast<std::int32_t>(n));
  if (choice.axis < 0) return split_at_median(records, bounds.box.box().longest_axis());
  return partition_records(records, [&](const WideBox& box) {
    alignas(16) std::int32_t at[4];
    hn::Store(binning(box), Int4(), at);
    return at[choice.axis] < choice.bin;
  });
}

}  // namespace raystudy::topdown
