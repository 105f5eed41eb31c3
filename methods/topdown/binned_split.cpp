#include "methods/topdown/binned_split.h"

#include <algorithm>
#include <array>
#include <bit>

namespace raystudy::topdown {

std::vector<ParamSpec> binned_params() {
  std::vector<ParamSpec> specs{
      integer_param("bins", 32, "bins an axis, at most", 2, 1024),
      method_param("heuristic", Role::heuristic, "surface-area", "the measure whose cost the splits minimize")};
  for (ParamSpec& spec : LeafPolicy::params()) specs.push_back(std::move(spec));
  return specs;
}

BinnedSplitter::BinnedSplitter(const Measure& measure, std::uint32_t bins, int threads)
    : most_(bins), threads_(threads), bins_((bins + 3) / 4 * 4), odd_((bins + 3) / 4 * 4), sweep_(measure, most_) {}

void BinnedSplitter::Bins::clear(std::uint32_t row) {
  const WideBox empty = WideBox::empty();
  BoxRecord* box = boxes.data();
  for (const BoxRecord* end = box + std::size_t{3} * row; box < end; ++box) empty.store(*box);
  std::fill_n(counts.begin(), std::size_t{3} * row, 0);
}

void BinnedSplitter::Bins::merge(const Bins& other, std::uint32_t row) {
  for (std::size_t i = 0; i < std::size_t{3} * row; ++i) {
    united(WideBox::of(boxes[i]), WideBox::of(other.boxes[i])).store(boxes[i]);
    counts[i] += other.counts[i];
  }
}

BinnedSplitter::Binning::Binning(const NodeBounds& bounds, std::uint32_t bins, std::uint32_t row_size)
    : origin(bounds.first_center), last(hn::Set(Float4(), static_cast<float>(bins) - 1)) {
  const Float4 d;
  const auto extent = hn::Sub(bounds.last_center, bounds.first_center);
  const auto some = hn::And(hn::Gt(extent, hn::Zero(d)), hn::FirstN(d, 3));
  row = hn::Mul(hn::Iota(Int4(), 0), hn::Set(Int4(), static_cast<std::int32_t>(4 * row_size)));
  scale = hn::IfThenElseZero(some, hn::Div(hn::Set(d, static_cast<float>(bins)), extent));
  // The fourth lane of a record looks like a denormal number, and to multiply those is very slow; a 1 takes it away.
  origin = hn::IfThenElse(hn::FirstN(d, 3), origin, hn::Set(d, 1.0F));
}

Plane BinnedSplitter::Binning::plane(int axis, std::int32_t bin) const {
  const Float4 d;
  alignas(16) float origins[4];
  alignas(16) float scales[4];
  hn::Store(origin, d, origins);
  hn::Store(scale, d, scales);
  return {axis, origins[axis], scales[axis], static_cast<float>(bin)};
}

namespace {

/// Pointers of their own: of vectors behind a reference the compiler would have to fear that a store changes them.
struct BinPointers {
  char* boxes;
  char* counts;

  BinPointers(std::span<BoxRecord> b, std::span<std::int32_t> c)
      : boxes(reinterpret_cast<char*>(b.data())), counts(reinterpret_cast<char*>(c.data())) {}

  void add(const WideBox& box, hn::Vec<Int4> bins) const {
    const auto at = std::bit_cast<std::array<std::uint32_t, 4>>(bins);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t offset = at[axis];
      BoxRecord& bin = *reinterpret_cast<BoxRecord*>(boxes + 8 * offset);
      united(WideBox::of(bin), box).store(bin);
      ++*reinterpret_cast<std::int32_t*>(counts + offset);
    }
  }
};

}  // namespace

void BinnedSplitter::fill(Bins& bins, std::span<const BoxRecord> records, const Binning& by_value) {
  const BinPointers to(bins.boxes, bins.counts);
  const Binning binning = by_value;
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    to.add(box, binning(box));
  }
}

void BinnedSplitter::fill_alternating(std::span<const BoxRecord> records, const Binning& by_value) {
  // Neighbours often share a bin, and the second then waits for the first's stores; with two sets of bins it does not.
  const BinPointers even(bins_.boxes, bins_.counts);
  const BinPointers odd(odd_.boxes, odd_.counts);
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
  const auto parts = pass_in_blocks(records, threads_, [&](std::span<const BoxRecord> part, std::size_t) {
    auto bins = std::make_unique<Bins>(row_);
    bins->clear(row_);
    fill(*bins, part, binning);
    return bins;
  });
  bins_.clear(row_);
  for (const auto& part : parts) bins_.merge(*part, row_);
}

Split BinnedSplitter::split(std::span<const BoxRecord> records, const NodeBounds& bounds) {
  const auto n = static_cast<std::uint32_t>(records.size());
  count_ = std::min(most_, 4 + n / 4);
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
  const BinChoice choice = sweep_.best({bins_.boxes.data(), bins_.counts.data(), row_}, static_cast<std::int32_t>(n));
  if (choice.axis < 0) return {{.axis = bounds.box.box().longest_axis()}, 0};
  return {binning.plane(choice.axis, choice.bin), static_cast<std::uint32_t>(choice.left)};
}

namespace {

/// split_at_median for a few.
FewSet few_at_median(const FewBoxes& boxes, FewSet set) {
  const int axis = WideBox::of(boxes.of(set)).box().longest_axis();
  const auto before = [&](const BoxRecord& a, const BoxRecord& b) {
    const float ca = doubled_center(a, axis);
    const float cb = doubled_center(b, axis);
    return ca < cb || (ca == cb && a.triangle < b.triangle);
  };
  FewSet left = 0;
  for (FewSet one = 1; one <= set; one <<= 1) {
    int rank = 0;
    for (FewSet other = 1; other <= set; other <<= 1) {
      if ((set & other) != 0) rank += before(boxes.of(other), boxes.of(one)) ? 1 : 0;
    }
    if ((set & one) != 0 && rank < std::popcount(set) / 2) left |= one;
  }
  return left;
}

}  // namespace

std::array<WideBox, 2> BinnedSplitter::sides(const Plane& plane) const {
  return bin_sides(&bins_.boxes[static_cast<std::size_t>(plane.axis) * row_], row_, static_cast<std::uint32_t>(plane.bound));
}

FewSet BinnedSplitter::split_few(const FewBoxes& boxes, FewSet set) const {
  const Float4 d;
  NodeBounds bounds;
  for (FewSet rest = set; rest != 0; rest &= rest - 1) bounds.extend(boxes.of(rest & (0U - rest)));
  const std::uint32_t bins = std::min(most_, FewBoxes::most);
  const Binning binning(bounds, bins, 4);
  const auto at = [&](FewSet one) { return binning.place(WideBox::of(boxes.of(one))); };
  // Transposed, so that a comparison with a bin tells which boxes go left.
  const Lanes places(at(1), at(2), at(4), at(8));
  float least = std::numeric_limits<float>::infinity();
  FewSet best = 0;
  for (const auto& axis : {places.x, places.y, places.z}) {
    for (std::uint32_t bin = 1; bin < bins; ++bin) {
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Lt(axis, hn::Set(d, static_cast<float>(bin))), bits);
      const FewSet left = bits[0] & set;
      const float cost = boxes.weight(left) + boxes.weight(set ^ left);
      const bool better = cost < least;
      least = better ? cost : least;
      best = better ? left : best;
    }
  }
  return best != 0 ? best : few_at_median(boxes, set);
}

}  // namespace raystudy::topdown
