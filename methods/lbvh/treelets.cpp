#include "methods/lbvh/treelets.h"

#include <algorithm>
#include <limits>
#include <mutex>

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
    const Box box = root.box.box();
    treelets[i] = {box, MortonGrid::center(box), root.place - place, root.leaf + 1 - leaf, static_cast<std::uint32_t>(i), {}};
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
    Box box;
    for (const Treelet& treelet : treelets) box.extend(treelet.box);
    const std::size_t middle = splitter.split(treelets, {scratch_.data() + range.begin, n});
    TreeletPlace right = range.place;
    for (const Treelet& treelet : treelets.first(middle)) {
      right.leaf += treelet.leaves;
      right.triangle += treelet.triangles;
    }
    const std::uint32_t pair = 2 * right.leaf;
    nodes_[range.slot] = {box, pair, 0};
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
    : measure_(measure),
      bins_(bins),
      boxes_(std::size_t{3} * bins),
      triangles_(boxes_.size()),
      sides_(2 * boxes_.size()),
      measures_(sides_.size()),
      before_(boxes_.size()) {}

void TreeletSplitter::fill(std::span<Treelet> treelets) {
  Box centers;
  for (const Treelet& treelet : treelets) centers.extend(treelet.center);
  const MortonGrid grid(centers, cell_bits);
  std::fill(boxes_.begin(), boxes_.end(), Box{});
  std::fill(triangles_.begin(), triangles_.end(), 0U);
  for (Treelet& treelet : treelets) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t bin = grid.cell(treelet.center, axis) * bins_ >> static_cast<unsigned>(cell_bits);
      treelet.bins[axis] = static_cast<std::uint16_t>(bin);
      const std::size_t at = static_cast<std::size_t>(axis) * bins_ + bin;
      boxes_[at].extend(treelet.box);
      triangles_[at] += treelet.triangles;
    }
  }
}

TreeletSplitter::Choice TreeletSplitter::best() {
  const std::size_t all = boxes_.size();
  std::uint32_t triangles = 0;
  for (std::size_t row = 0; row < all; row += bins_) {
    Box left;
    Box right;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < bins_; ++i) {
      left.extend(boxes_[row + i]);
      sides_[row + i] = left;
      before_[row + i] = count += triangles_[row + i];
      sides_[all + row + bins_ - 1 - i] = right;
      right.extend(boxes_[row + bins_ - 1 - i]);
    }
    triangles = count;
  }
  measure_.evaluate(sides_, measures_);
  Choice choice;
  float least = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < all; ++i) {
    const std::uint32_t behind = triangles - before_[i];
    if (before_[i] == 0 || behind == 0) continue;
    const float cost = measures_[i] * static_cast<float>(before_[i]) + measures_[all + i] * static_cast<float>(behind);
    if (!(cost < least)) continue;
    least = cost;
    choice = {static_cast<int>(i / bins_), static_cast<std::uint32_t>(i % bins_) + 1};
  }
  return choice;
}

std::size_t TreeletSplitter::split(std::span<Treelet> treelets, std::span<Treelet> scratch) {
  fill(treelets);
  const Choice choice = best();
  if (choice.axis < 0) return treelets.size() / 2;
  std::size_t left = 0;
  std::size_t right = 0;
  for (const Treelet& treelet : treelets) {
    if (treelet.bins[choice.axis] < choice.bin) {
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
