#include "methods/lbvh/treelets.h"

#include <algorithm>

#include "harness/base/parallel.h"
#include "harness/geometry/morton.h"

namespace raystudy::lbvh {
namespace {

constexpr int cell_bits = 16;

/// Nodes over at least this many treelets may be split beside each other.
constexpr std::size_t shared = 2048;

std::vector<Treelet> treelets_of(std::span<const Part> roots) {
  std::vector<Treelet> treelets(roots.size());
  std::uint32_t leaf = 0;
  std::uint32_t place = 0;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const Part& root = roots[i];
    treelets[i] = {
        root.box, MortonGrid::center(root.box.box()), root.place - place, root.leaf + 1 - leaf, static_cast<std::uint32_t>(i),
        {}};
    leaf = root.leaf + 1;
    place = root.place;
  }
  return treelets;
}

/// Treelets that a node is over, the slot of the node, and the numbers of its first leaf and of its first triangle.
struct Range {
  std::size_t begin;
  std::size_t end;
  std::uint32_t slot;
  TreeletPlace place;
};

class OverTreelets {
 public:
  OverTreelets(std::span<const Part> roots, const Measure& measure, std::uint32_t bins, int threads, Bvh2Node* nodes)
      : roots_(roots),
        measure_(measure),
        bins_(bins),
        threads_(threads),
        nodes_(nodes),
        treelets_(treelets_of(roots)),
        scratch_(roots.size()),
        places_(roots.size()) {}

  std::vector<TreeletPlace> run() {
    build({0, roots_.size(), 0, {0, 0}});
    tasks_.wait();
    return std::move(places_);
  }

 private:
  void build(const Range& all) {
    TreeletSplitter splitter(measure_, bins_);
    std::vector<Range> ranges{all};
    while (!ranges.empty()) {
      const Range range = ranges.back();
      ranges.pop_back();
      if (range.end - range.begin == 1) {
        place(treelets_[range.begin].number, range);
        continue;
      }
      const auto [left, right] = split(range, splitter);
      ranges.push_back(left);
      if (threads_ > 1 && right.end - right.begin >= shared) {
        tasks_.run([this, right = right] { build(right); });
      } else {
        ranges.push_back(right);
      }
    }
  }

  std::pair<Range, Range> split(const Range& range, TreeletSplitter& splitter) {
    const std::size_t n = range.end - range.begin;
    const std::span<Treelet> treelets{treelets_.data() + range.begin, n};
    WideBox box = WideBox::empty();
    for (const Treelet& treelet : treelets) box = united(box, treelet.box);
    const std::size_t middle = splitter.split(treelets, {scratch_.data() + range.begin, n});
    TreeletPlace right = range.place;
    for (const Treelet& treelet : treelets.first(middle)) {
      right.leaf += treelet.leaves;
      right.triangle += treelet.triangles;
    }
    const std::uint32_t pair = 2 * right.leaf;
    set_node(nodes_[range.slot], box, pair, 0);
    return {{range.begin, range.begin + middle, pair, range.place}, {range.begin + middle, range.end, pair + 1, right}};
  }

  void place(std::uint32_t number, const Range& range) {
    const Part& root = roots_[number];
    const std::uint32_t leaf = number == 0 ? 0 : roots_[number - 1].leaf + 1;
    const std::uint32_t triangle = number == 0 ? 0 : roots_[number - 1].place;
    places_[number] = range.place;
    const bool inner = root.count == 0;
    set_node(nodes_[range.slot], root.box, root.first + (inner ? 2 * (range.place.leaf - leaf) : range.place.triangle - triangle),
             root.count);
  }

  std::span<const Part> roots_;
  const Measure& measure_;
  std::uint32_t bins_;
  int threads_;
  Bvh2Node* nodes_;
  std::vector<Treelet> treelets_;
  std::vector<Treelet> scratch_;
  std::vector<TreeletPlace> places_;  ///< by number
  TaskGroup tasks_;
};

}  // namespace

TreeletSplitter::TreeletSplitter(const Measure& measure, std::uint32_t bins)
    : bins_(bins), row_((bins + 3) / 4 * 4), boxes_(std::size_t{3} * row_), counts_(boxes_.size()), sweep_(measure, bins) {}

std::int32_t TreeletSplitter::fill(std::span<Treelet> treelets) {
  Box centers;
  for (const Treelet& treelet : treelets) centers.extend(treelet.center);
  const MortonGrid grid(centers, cell_bits);
  for (topdown::BoxRecord& box : boxes_) WideBox::empty().store(box);
  std::fill(counts_.begin(), counts_.end(), 0);
  std::int32_t triangles = 0;
  for (Treelet& treelet : treelets) {
    triangles += static_cast<std::int32_t>(treelet.triangles);
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t bin = grid.cell(treelet.center, axis) * bins_ >> static_cast<unsigned>(cell_bits);
      treelet.bins[axis] = static_cast<std::uint16_t>(bin);
      const std::size_t at = static_cast<std::size_t>(axis) * row_ + bin;
      united(WideBox::of(boxes_[at]), treelet.box).store(boxes_[at]);
      counts_[at] += static_cast<std::int32_t>(treelet.triangles);
    }
  }
  return triangles;
}

std::size_t TreeletSplitter::split(std::span<Treelet> treelets, std::span<Treelet> scratch) {
  const std::int32_t triangles = fill(treelets);
  const topdown::BinChoice choice = sweep_.best({boxes_.data(), counts_.data(), row_}, triangles);
  if (choice.axis < 0) return treelets.size() / 2;
  std::size_t left = 0;
  std::size_t right = 0;
  for (const Treelet& treelet : treelets) {
    if (treelet.bins[choice.axis] < static_cast<std::uint32_t>(choice.bin)) {
      treelets[left++] = treelet;
    } else {
      scratch[right++] = treelet;
    }
  }
  std::copy_n(scratch.begin(), right, treelets.begin() + static_cast<std::ptrdiff_t>(left));
  return left;
}

std::vector<TreeletPlace> build_over_treelets(std::span<const Part> roots, const Measure& measure, std::uint32_t bins,
                                              int threads, Bvh2Node* nodes) {
  return OverTreelets(roots, measure, bins, threads, nodes).run();
}

}  // namespace raystudy::lbvh
