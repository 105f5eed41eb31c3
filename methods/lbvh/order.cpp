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
  parallel_for_each(parts, [&](std::size_t part) {
    WideBox all = WideBox::empty();
    const std::size_t end = n * (part + 1) / parts;
    for (std::size_t t = n * part / parts; t < end; ++t) all = united(all, boxes(static_cast<std::uint32_t>(t)));
    bounds[part] = all.box();
  });
  Box all;
  for (const Box& box : bounds) all.extend(box);
  return all;
}

/// to[i] = the most of from[i] to from[i + width - 1]; from[0] to from[n + width - 2] are there and lost.
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
  parallel_for_blocks(n, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::uint32_t>(i);
      items[i] = {static_cast<Code>(grid.code(MortonGrid::center(boxes(t).box()))), t};
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
