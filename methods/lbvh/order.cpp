#include "methods/lbvh/order.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/geometry/morton.h"

namespace raystudy::lbvh {
namespace {

/// Triangles that a task takes at a time.
constexpr std::size_t grain = 8192;

/// The box of all triangles.
Box bounds_of(const TriangleBoxes& boxes, std::size_t n, int threads) {
  const std::size_t parts = threads == 1 ? 1 : std::clamp<std::size_t>(n / grain, 1, 4 * static_cast<std::size_t>(threads));
  std::vector<Box> bounds(parts);
  parallel_for_each(parts, [&bounds, boxes, n, parts](std::size_t part) {
    WideBox all = WideBox::empty();
    const std::size_t end = n * (part + 1) / parts;
    for (std::size_t t = n * part / parts; t < end; ++t) all = united(all, boxes(static_cast<std::uint32_t>(t)));
    bounds[part] = all.box();
  });
  Box all;
  for (const Box& box : bounds) all.extend(box);
  return all;
}

#if HWY_MAX_BYTES >= 32
/// The codes of MortonGrid from boxes in registers, the axes side by side.
template <class Code>
class Coder {
 public:
  explicit Coder(const MortonGrid& grid)
      : half_lower_(lanes(grid.half_lower())), scale_(lanes(grid.scale())), last_(hn::Set(Float4(), grid.last_cell())) {}

  /// The fourth lanes of the box's halves must be 0.
  [[nodiscard]] Code operator()(const WideBox& box) const {
    const Float4 d;
    const auto half = hn::Set(d, 0.5F);
    const auto center = hn::Sub(hn::Mul(half, box.lower()), hn::Mul(half, box.negated_upper()));
    const auto place = hn::Mul(hn::Sub(hn::Mul(half, center), half_lower_), scale_);
    const auto cell = hn::IfThenElseZero(hn::Gt(place, hn::Zero(d)), hn::Min(place, last_));
    return merged(hn::BitCast(hn::FixedTag<std::uint32_t, 4>(), hn::ConvertTo(topdown::Int4(), cell)));
  }

 private:
  static hn::Vec<Float4> lanes(Vec3 v) {
    alignas(16) const float values[4] = {v.x, v.y, v.z, 0};
    return hn::Load(Float4(), values);
  }

  /// morton_code: each step of spread_bits on all axes at once.
  static Code merged(hn::Vec<hn::FixedTag<std::uint32_t, 4>> cells) {
    const hn::FixedTag<Code, 4> d;
    alignas(32) static constexpr Code shifts[4] = {2, 1, 0, 0};
    hn::Vec<hn::FixedTag<Code, 4>> v;
    if constexpr (sizeof(Code) == 8) {
      v = hn::PromoteTo(d, cells);
      v = spread<32>(v, 0x001f00000000ffffU);
      v = spread<16>(v, 0x001f0000ff0000ffU);
      v = spread<8>(v, 0x100f00f00f00f00fU);
      v = spread<4>(v, 0x10c30c30c30c30c3U);
      v = spread<2>(v, 0x1249249249249249U);
    } else {  // of 10 bits
      v = spread<16>(cells, 0x030000ffU);
      v = spread<8>(v, 0x0300f00fU);
      v = spread<4>(v, 0x030c30c3U);
      v = spread<2>(v, 0x09249249U);
    }
    v = hn::Shl(v, hn::Load(d, shifts));
    const hn::Half<decltype(d)> half;
    const auto two = hn::Or(hn::LowerHalf(half, v), hn::UpperHalf(half, v));
    return hn::ExtractLane(two, 0) | hn::ExtractLane(two, 1);
  }

  template <int by>
  static auto spread(hn::Vec<hn::FixedTag<Code, 4>> v, Code kept) {
    return hn::And(hn::Or(v, hn::ShiftLeft<by>(v)), hn::Set(hn::FixedTag<Code, 4>(), kept));
  }

  hn::Vec<Float4> half_lower_;
  hn::Vec<Float4> scale_;
  hn::Vec<Float4> last_;
};
#else
template <class Code>
class Coder {
 public:
  explicit Coder(const MortonGrid& grid) : grid_(grid) {}
  [[nodiscard]] Code operator()(const WideBox& box) const { return static_cast<Code>(grid_.code(MortonGrid::center(box.box()))); }

 private:
  MortonGrid grid_;
};
#endif

/// Of n + width - 1 values: sets values[i], i < n, to the most of values[i] to values[i + width - 1]. Those behind are lost.
template <class Most>
void slide(Gap* values, std::size_t n, std::size_t width, const Most& most) {
  const auto widen = [&](std::size_t by, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) values[i] = most(values[i], values[i + by]);
  };
  std::size_t reach = 1;
  for (; 2 * reach <= width; reach *= 2) widen(reach, n + width - 2 * reach);
  if (reach < width) widen(width - reach, n);
}

/// Marks the ends of leaves among `count` gaps, given at `gaps` with width - 1 more on either side. A gap ends a leaf if the
/// range that it splits has more than `width` places: then, and only then, some window of `width` gaps has it as its highest.
void mark_leaf_ends(std::vector<Gap>& gaps, std::size_t count, std::size_t width, Gap* to) {
  std::copy_n(gaps.begin() + static_cast<std::ptrdiff_t>(width - 1), count, to);
  slide(gaps.data(), count + width - 1, width, [](Gap a, Gap b) { return std::max(a, b); });
  slide(gaps.data(), count, width, [](Gap a, Gap b) { return std::min(a, b); });
  for (std::size_t i = 0; i < count; ++i) to[i] = to[i] == gaps[i] ? to[i] | leaf_end : to[i];
}

template <class Code>
class GapFinder {
 public:
  GapFinder(std::span<const Code> codes, const Shape& shape)
      : codes_(codes),
        width_(std::min<std::size_t>(shape.max_leaf_triangles, codes.size())),
        treelet_(static_cast<Gap>(code_bit + shape.morton_bits - shape.treelet_bits)) {}

  void run(std::size_t begin, std::size_t end, Gap* gaps) const {
    if (width_ == 1) {
      for (std::size_t i = begin; i < end; ++i) gaps[i] = gap(i) | leaf_end;
      return;
    }
    const std::size_t margin = width_ - 1;
    const std::size_t step = std::max(grain, 4 * margin);
    std::vector<Gap> some;
    for (std::size_t from = begin; from < end; from += step) {
      const std::size_t to = std::min(from + step, end);
      some.assign(to - from + 2 * margin, treelet_end);
      const std::size_t first = from - std::min(from, margin);
      const std::size_t last = std::min(to + margin, codes_.size());
      for (std::size_t i = first; i < last; ++i) some[i + margin - from] = gap(i);
      mark_leaf_ends(some, to - from, width_, gaps + from);
    }
  }

 private:
  [[nodiscard]] Gap gap(std::size_t place) const {
    if (place + 1 == codes_.size()) return treelet_end;
    const Gap h = height(codes_.data(), place, place + 1);
    return h >= treelet_ ? treelet_end : h;
  }

  std::span<const Code> codes_;
  std::size_t width_;  ///< of windows: the most triangles of a leaf
  Gap treelet_;        ///< the least height between treelets
};

}  // namespace

template <class Code>
std::span<const Code> sort_by_code(const Scene& scene, int morton_bits, int threads, std::byte* room, std::uint32_t* order) {
  const std::size_t n = scene.triangles.size();
  const TriangleBoxes boxes(scene);
  const MortonGrid grid(bounds_of(boxes, n, threads), morton_bits / 3);
  auto* const items = reinterpret_cast<Keyed<Code>*>(room);
  auto* const codes = reinterpret_cast<Code*>(items + 2 * n);
  parallel_for_blocks(n, grain, threads, [boxes, items, code = Coder<Code>(grid)](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::uint32_t>(i);
      items[i] = {code(boxes(t)), t};
    }
  });
  radix_sort(items, items + n, n, morton_bits, threads, [&](std::size_t place, const Keyed<Code>& item) {
    order[place] = item.index;
    codes[place] = item.key;
  });
  return {codes, n};
}

template <class Code>
void find_gaps(std::span<const Code> codes, const Shape& shape, int threads, Gap* gaps) {
  const GapFinder<Code> finder(codes, shape);
  parallel_for_blocks(codes.size(), grain, threads, [&](std::size_t begin, std::size_t end) { finder.run(begin, end, gaps); });
}

template std::span<const std::uint32_t> sort_by_code(const Scene&, int, int, std::byte*, std::uint32_t*);
template std::span<const std::uint64_t> sort_by_code(const Scene&, int, int, std::byte*, std::uint32_t*);
template void find_gaps(std::span<const std::uint32_t>, const Shape&, int, Gap*);
template void find_gaps(std::span<const std::uint64_t>, const Shape&, int, Gap*);

}  // namespace raystudy::lbvh
