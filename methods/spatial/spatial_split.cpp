#include "methods/spatial/spatial_split.h"

#include <algorithm>
#include <bit>
#include <memory>

namespace raystudy::spatial {

using topdown::BinChoice;
using topdown::Int4;
using topdown::LeastCosts;

std::array<float, 4> BoxMeasure::operator()(const WideBox& b0, const WideBox& b1, const WideBox& b2, const WideBox& b3) const {
  if (surface_area_ != nullptr) return std::bit_cast<std::array<float, 4>>(topdown::half_areas(b0, b1, b2, b3));
  const std::array<Box, 4> boxes{b0.box(), b1.box(), b2.box(), b3.box()};
  std::array<float, 4> out{};
  measure_->evaluate(boxes, out);
  return out;
}

SpatialSplitter::SpatialSplitter(const Scene& scene, const BoxMeasure& measure, std::uint32_t bins, int threads)
    : scene_(scene),
      measure_(measure),
      most_(bins),
      threads_(threads),
      bins_((bins + 3) / 4 * 4),
      left_(bins_.parts.size()),
      right_(bins_.parts.size() + 1) {}

/// From coordinates to bins: bin i is [i, i + 1] in units of bins.
struct SpatialSplitter::Binning {
  Binning(const WideBox& box, std::uint32_t bins) : last(hn::Set(Float4(), static_cast<float>(bins) - 1)) {
    const Float4 d;
    const auto axes = hn::FirstN(d, 3);
    const auto extent = hn::Neg(hn::Add(box.lower(), box.negated_upper()));
    const auto some = hn::And(hn::Gt(extent, hn::Zero(d)), axes);
    // The fourth lane of a record looks like a denormal number, and to multiply those is very slow; a 1 takes it away.
    origin = hn::IfThenElse(axes, box.lower(), hn::Set(d, 1.0F));
    width = hn::IfThenElseZero(some, hn::Div(extent, hn::Set(d, static_cast<float>(bins))));
    scale = hn::IfThenElseZero(some, hn::Div(hn::Set(d, static_cast<float>(bins)), extent));
    hn::Store(origin, d, origins);
    hn::Store(width, d, widths);
  }

  struct Range {
    std::array<std::uint32_t, 4> first;
    std::array<std::uint32_t, 4> last;
  };
  /// The bins that a box meets on each axis. What only touches a border is not beyond it.
  [[nodiscard]] Range operator()(const WideBox& box) const {
    const auto zero = hn::Zero(Float4());
    // The minimum also holds what is not a number.
    const auto from = hn::Floor(hn::Min(hn::Mul(hn::Sub(box.lower(), origin), scale), last));
    const auto place = hn::Mul(hn::Sub(hn::Neg(box.negated_upper()), origin), scale);
    const auto to = hn::Max(hn::Min(hn::Sub(hn::Ceil(place), hn::Set(Float4(), 1.0F)), last), from);
    const auto as_bins = [&](hn::Vec<Float4> v) {
      return std::bit_cast<std::array<std::uint32_t, 4>>(hn::ConvertTo(Int4(), hn::Max(v, zero)));
    };
    return {as_bins(from), as_bins(to)};
  }
  [[nodiscard]] float border(int axis, std::uint32_t bin) const { return origins[axis] + widths[axis] * static_cast<float>(bin); }

  hn::Vec<Float4> origin;
  hn::Vec<Float4> width;
  hn::Vec<Float4> scale;
  hn::Vec<Float4> last;
  alignas(16) float origins[4];
  alignas(16) float widths[4];
};

namespace {

void add(BoxRecord& bin, const WideBox& box) { united(WideBox::of(bin), box).store(bin); }

void clear(std::vector<BoxRecord>& boxes, std::size_t size) {
  const WideBox empty = WideBox::empty();
  for (BoxRecord *box = boxes.data(), *end = box + size; box < end; ++box) empty.store(*box);
}
void clear(std::vector<std::int32_t>& counts, std::size_t size) { std::fill_n(counts.begin(), size, 0); }

void merge(std::vector<BoxRecord>& boxes, const std::vector<BoxRecord>& other, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) add(boxes[i], WideBox::of(other[i]));
}
void merge(std::vector<std::int32_t>& counts, const std::vector<std::int32_t>& other, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) counts[i] += other[i];
}

}  // namespace

template <class Pass, class... Arrays>
void SpatialSplitter::in_blocks(std::span<const BoxRecord> records, const Pass& pass, Arrays... arrays) {
  const std::size_t size = std::size_t{3} * row_;
  (clear(bins_.*arrays, size), ...);
  if (threads_ == 1 || records.size() < topdown::shared_pass) return pass(bins_, records);
  const auto blocks = topdown::pass_in_blocks(records, threads_, [&](std::span<const BoxRecord> part, std::size_t) {
    auto bins = std::make_unique<Bins>(row_);
    (clear((*bins).*arrays, size), ...);
    pass(*bins, part);
    return bins;
  });
  for (const auto& block : blocks) (merge(bins_.*arrays, (*block).*arrays, size), ...);
}

void SpatialSplitter::count(Bins& bins, std::span<const BoxRecord> records, const Binning& by_value) const {
  // Pointers of their own, as the compiler would have to fear that a store changes those behind a reference.
  const Binning binning = by_value;
  BoxRecord* begins = bins.begins.data();
  BoxRecord* ends = bins.ends.data();
  std::int32_t* enters = bins.enters.data();
  std::int32_t* exits = bins.exits.data();
  const std::size_t row = row_;
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    const auto [first, last] = binning(box);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t from = axis * row + first[axis];
      const std::size_t to = axis * row + last[axis];
      add(begins[from], box);
      add(ends[to], box);
      ++enters[from];
      ++exits[to];
    }
  }
}

void SpatialSplitter::chop(Bins& bins, std::span<const BoxRecord> records, const Binning& by_value, int axis) const {
  const Float4 d;
  const Binning binning = by_value;
  BoxRecord* row = &bins.parts[static_cast<std::size_t>(axis) * row_];
  for (const BoxRecord& record : records) {
    const WideBox box = WideBox::of(record);
    const auto range = binning(box);
    std::uint32_t bin = range.first[static_cast<std::size_t>(axis)];
    const std::uint32_t last = range.last[static_cast<std::size_t>(axis)];
    if (bin == last) {
      add(row[bin], box);
      continue;
    }
    const Slicer slicer(Corners(scene_, record.triangle), axis);
    auto from = hn::Set(d, record.lower[axis]);
    Extent first_cut = slicer.cut(from);
    for (; bin <= last; ++bin) {
      const auto to = hn::Set(d, bin < last ? binning.border(axis, bin + 1) : -record.negated_upper[axis]);
      const Extent last_cut = slicer.cut(to);
      const Extent part = slicer.between(from, first_cut, to, last_cut);
      add(row[bin], common(box, WideBox::of(part.lower, hn::Neg(part.upper))));
      from = to;
      first_cut = last_cut;
    }
  }
}

void SpatialSplitter::measure_sides(const std::vector<BoxRecord>& lefts, const std::vector<BoxRecord>& rights,
                                    std::uint32_t row) {
  const Float4 d;
  WideBox left = WideBox::empty();
  WideBox right = WideBox::empty();
  if (measure_.is_surface_area()) {
    // Of what is empty the area is infinite.
    const auto finite = [&](hn::Vec<Float4> m) {
      return hn::IfThenElseZero(hn::Lt(m, hn::Set(d, std::numeric_limits<float>::infinity())), m);
    };
    const auto l = [&](std::uint32_t i) { return WideBox::of(lefts[i]); };
    const auto r = [&](std::uint32_t i) { return WideBox::of(rights[i]); };
    for (std::uint32_t i = row, j = row + row_; i < row + row_; i += 4, j -= 4) {
      hn::StoreU(finite(topdown::grow<false>(left, l(i), l(i + 1), l(i + 2), l(i + 3))), d, &left_[i]);
      hn::StoreU(finite(topdown::grow<true>(right, r(j - 1), r(j - 2), r(j - 3), r(j - 4))), d, &right_[j - 4]);
    }
    return;
  }
  std::vector<Box> left_boxes(row_);
  std::vector<Box> right_boxes(row_);
  for (std::uint32_t i = 0, j = row_; i < row_; ++i) {
    left = united(left, WideBox::of(lefts[row + i]));
    left_boxes[i] = left.box();
    right = united(right, WideBox::of(rights[row + --j]));
    right_boxes[j] = right.box();
  }
  measure_.measure().evaluate(left_boxes, std::span(left_).subspan(row, row_));
  measure_.measure().evaluate(right_boxes, std::span(right_).subspan(row, row_));
}

void SpatialSplitter::consider(LeastCosts& least, std::uint32_t n, std::uint32_t extra, std::uint32_t row) const {
  const Float4 d;
  const Int4 di;
  const auto all = hn::Set(di, static_cast<std::int32_t>(n));
  const auto most = hn::Set(di, static_cast<std::int32_t>(n + extra));
  auto entered = hn::Zero(di);
  auto exited = hn::Zero(di);
  for (std::uint32_t i = row; i < row + row_; i += 4) {
    const auto lefts = topdown::running_sums(entered, &bins_.enters[i]);
    const auto ended = topdown::running_sums(exited, &bins_.exits[i]);
    entered = hn::Broadcast<3>(lefts);
    exited = hn::Broadcast<3>(ended);
    const auto rights = hn::Sub(all, ended);
    const auto too_many = hn::Gt(hn::Add(lefts, rights), most);
    // None on the right is no split.
    least.consider(i, hn::LoadU(d, &left_[i]), hn::LoadU(d, &right_[i + 1]), lefts, hn::IfThenZeroElse(too_many, rights));
  }
}

SpatialSplit SpatialSplitter::split(std::span<const BoxRecord> records, const WideBox& box, std::uint32_t extra, float limit) {
  const auto n = static_cast<std::uint32_t>(records.size());
  count_ = std::min(most_, 4 + n / 4);
  row_ = (count_ + 3) / 4 * 4;
  const Binning binning(box, count_);
  in_blocks(
      records, [&](Bins& bins, std::span<const BoxRecord> part) { count(bins, part, binning); }, &Bins::begins, &Bins::ends,
      &Bins::enters, &Bins::exits);
  LeastCosts least;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t row = static_cast<std::uint32_t>(axis) * row_;
    // What does not cross a plane is in its sides whatever the crossing references add: a bound, without a triangle chopped.
    LeastCosts bound;
    measure_sides(bins_.ends, bins_.begins, row);
    consider(bound, n, extra, row);
    if (!bound.is_below(limit)) continue;
    in_blocks(
        records, [&](Bins& bins, std::span<const BoxRecord> part) { chop(bins, part, binning, axis); }, &Bins::parts);
    measure_sides(bins_.parts, bins_.parts, row);
    consider(least, n, extra, row);
  }
  const BinChoice choice = least.choice(row_);
  if (choice.axis < 0 || !least.is_below(limit)) return {};
  const std::size_t row = static_cast<std::size_t>(choice.axis) * row_;
  const auto bin = static_cast<std::uint32_t>(choice.bin);
  SpatialSplit split{topdown::bin_sides(&bins_.parts[row], row_, bin), {}, choice.axis, binning.border(choice.axis, bin)};
  split.counts[0] = static_cast<std::uint32_t>(choice.left);
  for (std::uint32_t i = bin; i < row_; ++i) split.counts[1] += static_cast<std::uint32_t>(bins_.exits[row + i]);
  return split;
}

}  // namespace raystudy::spatial
