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
      right_(bins_.boxes.size() + 1) {}

void BinnedSplitter::Bins::clear(std::uint32_t row) {
  const WideBox empty = WideBox::empty();
  for (std::size_t i = 0; i < std::size_t{3} * row; ++i) empty.store(boxes[i]);
  std::fill_n(counts.begin(), std::size_t{3} * row, 0);
}

void BinnedSplitter::Bins::merge(const Bins& other, std::uint32_t row) {
  for (std::size_t i = 0; i < std::size_t{3} * row; ++i) {
    united(WideBox::of(boxes[i]), WideBox::of(other.boxes[i])).store(boxes[i]);
    counts[i] += other.counts[i];
  }
}

BinnedSplitter::Binning::Binning(const NodeBounds& bounds, std::uint32_t bins)
    : origin(bounds.first_center), last(hn::Set(Float4(), static_cast<float>(bins) - 1)) {
  const Float4 d;
  const auto extent = hn::Sub(bounds.last_center, bounds.first_center);
  const auto some = hn::And(hn::Gt(extent, hn::Zero(d)), hn::FirstN(d, 3));
  scale = hn::IfThenElseZero(some, hn::Div(hn::Set(d, static_cast<float>(bins)), extent));
  // The fourth lane of a record looks like a denormal number, and to multiply those is very slow; a 1 takes it away.
  origin = hn::IfThenElse(hn::FirstN(d, 3), origin, hn::Set(d, 1.0F));
}

BinnedSplitter::Binning::OnAxis BinnedSplitter::Binning::on_axis(int axis) const {
  const Float4 d;
  alignas(16) float origins[4];
  alignas(16) float scales[4];
  hn::Store(origin, d, origins);
  hn::Store(scale, d, scales);
  return {axis, origins[axis], scales[axis], hn::GetLane(last)};
}

namespace {

/// Pointers of their own: of vectors behind a reference the compiler would have to fear that a store changes them.
struct BinPointers {
  BoxRecord* boxes[3];
  std::int32_t* counts[3];

  BinPointers(std::span<BoxRecord> b, std::span<std::int32_t> c, std::size_t row)
      : boxes{b.data(), b.data() + row, b.data() + 2 * row}, counts{c.data(), c.data() + row, c.data() + 2 * row} {}

  void add(const WideBox& box, hn::Vec<Int4> bins) const {
    alignas(16) std::int32_t at[4];
    hn::Store(bins, Int4(), at);
    for (int axis = 0; axis < 3; ++axis) {
      BoxRecord& bin = boxes[axis][at[axis]];
      united(WideBox::of(bin), box).store(bin);
      ++counts[axis][at[axis]];
    }
  }
};

}  // namespace

void BinnedSplitter::fill(Bins& bins, std::uint32_t row, std::span<const BoxRecord> records, const Binning& by_value) {
  const BinPointers to(bins.boxes, bins.counts, row);
  const Binning binning = by_value;
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    to.add(box, binning(box));
  }
}

void BinnedSplitter::fill_alternating(std::span<const BoxRecord> records, const Binning& by_value) {
  // Neighbours often share a bin, and the second then waits for the first's stores; with two sets of bins it does not.
  const BinPointers even(bins_.boxes, bins_.counts, row_);
  const BinPointers odd(odd_.boxes, odd_.counts, row_);
  const Binning binning = by_value;
  odd_.clear(row_);
  std::size_t i = 0;
  for (; i + 1 < records.size(); i += 2) {
    const WideBox a = WideBox::of(records[i]);
    const WideBox b = WideBox::of(records[i + 1]);
    even.add(a, binning(a));
    odd.add(b, binning(b));
  }
  fill(bins_, row_, records.subspan(i), binning);
  bins_.merge(odd_, row_);
}

void BinnedSplitter::fill_shared(std::span<const BoxRecord> records, const Binning& binning) {
  const auto parts = pass_in_blocks(records, threads_, [&](std::span<const BoxRecord> part) {
    auto bins = std::make_unique<Bins>(row_);
    bins->clear(row_);
    fill(*bins, row_, part, binning);
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
  const Float4 d;
  const Int4 di;
  const float infinity = std::numeric_limits<float>::infinity();
  auto least = hn::Set(d, infinity);
  auto where = hn::Zero(di);  // of the least cost in the lane: the bin before the split
  auto left_then = hn::Zero(di);
  const auto all = hn::Set(di, n);
  for (std::uint32_t row = 0; row < 3 * row_; row += row_) {
    auto left = hn::Zero(di);
    for (std::uint32_t i = row; i < row + row_; i += 4) {
      auto counts = hn::LoadU(di, &bins_.counts[i]);
      counts = hn::Add(counts, hn::ShiftLeftLanes<1>(di, counts));
      counts = hn::Add(counts, hn::ShiftLeftLanes<2>(di, counts));
      const auto lefts = hn::Add(left, counts);
      const auto rights = hn::Sub(all, lefts);
      left = hn::Broadcast<3>(lefts);
      const auto cost = hn::Add(hn::Mul(hn::LoadU(d, &left_[i]), hn::ConvertTo(d, lefts)),
                                hn::Mul(hn::LoadU(d, &right_[i + 1]), hn::ConvertTo(d, rights)));
      const auto some = hn::And(hn::Gt(lefts, hn::Zero(di)), hn::Gt(rights, hn::Zero(di)));
      const auto better = hn::And(hn::Lt(cost, least), hn::RebindMask(d, some));
      least = hn::IfThenElse(better, cost, least);
      where = hn::IfThenElse(hn::RebindMask(di, better), hn::Iota(di, static_cast<std::int32_t>(i)), where);
      left_then = hn::IfThenElse(hn::RebindMask(di, better), lefts, left_then);
    }
  }
  alignas(16) float costs[4];
  alignas(16) std::int32_t at[4];
  alignas(16) std::int32_t lefts[4];
  hn::Store(least, d, costs);
  hn::Store(where, di, at);
  hn::Store(left_then, di, lefts);
  int best = 0;
  for (int i = 1; i < 4; ++i) {
    const bool better = (costs[i] < costs[best]) | ((costs[i] == costs[best]) & (at[i] < at[best]));
    best = better ? i : best;
  }
  if (!(costs[best] < infinity)) return {};
  const auto row = static_cast<std::int32_t>(row_);
  return {at[best] / row, at[best] % row + 1, lefts[best]};
}

Division BinnedSplitter::split(std::span<BoxRecord> records, BoxRecord* spare, const NodeBounds& bounds) {
  const auto n = static_cast<std::uint32_t>(records.size());
  count_ = std::min(most_, std::max(n, 4U));
  row_ = (count_ + 3) / 4 * 4;
  const Binning binning(bounds, count_);
  if (threads_ > 1 && records.size() >= shared_pass) {
    fill_shared(records, binning);
  } else {
    bins_.clear(row_);
    if (n >= 128) {
      fill_alternating(records, binning);
    } else {
      fill(bins_, row_, records, binning);
    }
  }
  measure_sides();
  const Choice choice = best_choice(static_cast<std::int32_t>(n));
  if (choice.axis < 0) return split_at_median(records, bounds.box.box().longest_axis());
  const auto bin = binning.on_axis(choice.axis);
  const auto left = static_cast<std::uint32_t>(choice.left);
  divide_records(records, spare, spare + left, [&](const BoxRecord& record) { return bin(record) < choice.bin; });
  return {left, true};
}

}  // namespace raystudy::topdown
