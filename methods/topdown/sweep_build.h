#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/method/method.h"
#include "methods/topdown/sweep_orders.h"
#include "methods/topdown/sweep_scan.h"
#include "methods/topdown/top_down.h"

namespace raystudy::topdown {

/// A sweep build over triangles that were sorted once per order: each node evaluates every split of every order in O(n) and
/// divides all the orders stably in O(n), so that a level of the tree takes O(N) (Wald and Havran 2006, Sec. 4.3, without
/// splitting of triangles). `M` is SurfaceArea or AnyMeasure.
template <class M>
class SweepBuild {
 public:
  SweepBuild(const M& measure, const LeafPolicy& leaves, SweepOrders& orders, Bvh2& bvh, int threads)
      : measure_(measure), leaves_(leaves), orders_(orders), bvh_(bvh), threads_(threads) {}

  /// Fills a tree over one triangle at least, whose arrays are allocated: 2 n nodes, to be compacted where leaves hold more than
  /// one, and n triangles.
  void run() {
    const auto n = static_cast<std::uint32_t>(orders_.records.size());
    View view{orders_.records.data(), {}, nullptr, 0};
    for (const auto& list : orders_.lists) view.lists.push_back(list.get());
    const auto sides = std::make_unique_for_overwrite<std::uint8_t[]>(n);
    view.sides = sides.get();
    TaskGroup tasks;
    tasks.run([&] { build_large({0, 2, 0, n}, view, tasks); });
    tasks.wait();
  }

 private:
  /// Triangles and their orders, from `origin` in the final order of triangles. `lists` hold indices into `records` and `sides`.
  struct View {
    BoxRecord* records;
    std::vector<std::uint32_t*> lists;
    std::uint8_t* sides;  ///< of each record while a node is divided: 1 if it goes right
    std::uint32_t origin;
  };

  struct Split {
    float cost = std::numeric_limits<float>::infinity();
    std::uint32_t left = 0;  ///< triangles of the left child; 0: the node is a leaf
    int order = 0;
  };

  /// Room for the measures and for the division of one node.
  class Scratch {
   public:
    explicit Scratch(std::size_t n)
        : measures_(std::make_unique_for_overwrite<float[]>(n + 2 * measures_slack)),
          indices_(std::make_unique_for_overwrite<std::uint32_t[]>(n)) {}
    [[nodiscard]] float* measures() { return measures_.get() + measures_slack; }
    [[nodiscard]] std::uint32_t* indices() { return indices_.get(); }

   private:
    std::unique_ptr<float[]> measures_;
    std::unique_ptr<std::uint32_t[]> indices_;
  };

  static constexpr std::uint32_t large = 8192;  ///< smaller subtrees are one task
  static constexpr std::uint32_t tiny = 512;    ///< smaller subtrees are copied together again, for the nearest cache

  /// Splits nodes while they are large, and gives the smaller child of each away as a task. No recursion: a tree may be as deep
  /// as it has triangles.
  void build_large(Subtree s, const View& view, TaskGroup& tasks) {
    while (s.count > large) {
      const Split split = find_split(s, view);
      if (split.left == 0) return;
      divide(s, view, split);
      Subtree mine = s.left(split.left);
      Subtree other = s.right(split.left);
      if (other.count > mine.count) std::swap(mine, other);
      tasks.run([this, other, &view, &tasks] { build_large(other, view, tasks); });
      s = mine;
    }
    build_small(s, view);
  }

  /// A copy of a small subtree's boxes with orders that refer to it, so that the sweeps below find them in a near cache.
  class Local {
   public:
    Local(std::size_t capacity, int orders)
        : records_(std::make_unique_for_overwrite<BoxRecord[]>(capacity)),
          sides_(std::make_unique_for_overwrite<std::uint8_t[]>(capacity)),
          indices_(std::make_unique_for_overwrite<std::uint32_t[]>(capacity * static_cast<std::size_t>(orders))),
          view_{records_.get(), {}, sides_.get(), 0} {
      for (std::size_t order = 0; order < static_cast<std::size_t>(orders); ++order) {
        view_.lists.push_back(indices_.get() + order * capacity);
      }
    }

    const View& hold(const Subtree& s, const View& from) {
      const std::uint32_t* first = from.lists[0] + (s.begin - from.origin);
      for (std::uint32_t i = 0; i < s.count; ++i) {
        BoxRecord& record = from.records[first[i]];
        records_[i] = record;
        record.rank = i;
        view_.lists[0][i] = i;
      }
      for (std::size_t order = 1; order < view_.lists.size(); ++order) {
        const std::uint32_t* list = from.lists[order] + (s.begin - from.origin);
        for (std::uint32_t i = 0; i < s.count; ++i) view_.lists[order][i] = from.records[list[i]].rank;
      }
      view_.origin = s.begin;
      return view_;
    }

   private:
    std::unique_ptr<BoxRecord[]> records_;
    std::unique_ptr<std::uint8_t[]> sides_;
    std::unique_ptr<std::uint32_t[]> indices_;
    View view_;
  };

  void build_small(const Subtree& top, const View& view) {
    Scratch scratch(top.count);
    Local local(top.count, orders_.count());
    Local tiny_local(std::min(top.count, tiny), orders_.count());
    build_local(top, local.hold(top, view), scratch, &tiny_local);
  }

  void build_local(const Subtree& top, const View& view, Scratch& scratch, Local* tiny_local) {
    std::vector<Subtree> stack{top};
    while (!stack.empty()) {
      const Subtree s = stack.back();
      stack.pop_back();
      if (s.count <= 2) {
        build_pair(s, view);
        continue;
      }
      if (tiny_local != nullptr && s.count <= tiny) {
        build_local(s, tiny_local->hold(s, view), scratch, nullptr);
        continue;
      }
      const Split split = find_split(s, view, scratch);
      if (split.left == 0) continue;
      divide(s, view, split, scratch);
      stack.push_back(s.right(split.left));
      stack.push_back(s.left(split.left));
    }
  }

  [[nodiscard]] OrderedBoxes ordered(const Subtree& s, const View& view, int order) const {
    return {view.records, view.lists[static_cast<std::size_t>(order)] + (s.begin - view.origin), s.count};
  }

  void make_leaf(const Subtree& s, const View& view) {
    const OrderedBoxes boxes = ordered(s, view, 0);
    WideBox box = WideBox::empty();
    for (std::uint32_t i = 0; i < s.count; ++i) {
      box = united(box, boxes[i]);
      bvh_.triangles[s.begin + i] = boxes.records[boxes.list[i]].triangle;
    }
    bvh_.nodes[s.node] = {box.box(), s.begin, s.count};
  }

  /// One triangle, or two, which fall apart in one way only.
  void build_pair(const Subtree& s, const View& view) {
    if (s.count == 1) return make_leaf(s, view);
    const OrderedBoxes boxes = ordered(s, view, 0);
    const Box left = boxes[0].box();
    const Box right = boxes[1].box();
    const Box box = united(left, right);
    if (leaves_.sah && leaves_.is_leaf(2, measure_(box), measure_(left) + measure_(right))) return make_leaf(s, view);
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    bvh_.nodes[s.pairs] = {left, s.begin, 1};
    bvh_.nodes[s.pairs + 1] = {right, s.begin + 1, 1};
    bvh_.triangles[s.begin] = view.records[boxes.list[0]].triangle;
    bvh_.triangles[s.begin + 1] = view.records[boxes.list[1]].triangle;
  }

  /// The best split of one order, and, with `order` 0, the node's box.
  Split best_of_order(const Subtree& s, const View& view, int order, Scratch& scratch, Box* box) {
    const OrderedBoxes boxes = ordered(s, view, order);
    if constexpr (std::is_same_v<M, SurfaceArea>) {
      if (s.count <= 4) {
        WideBox all = WideBox::empty();
        Split split{0, 0, order};
        split.cost = best_of_few(measure_, boxes, all, split.left);
        if (order == 0) *box = all.box();
        return split;
      }
    }
    float* measures = scratch.measures();
    const WideBox all = suffix_measures(measure_, boxes, measures);
    if (order == 0) *box = all.box();
    Split split{split_costs(measure_, boxes, measures), 0, order};
    if (split.cost < std::numeric_limits<float>::infinity()) split.left = most_balanced(measures, s.count, split.cost);
    return split;
  }

  Split find_split(const Subtree& s, const View& view, Scratch& scratch) {
    Box box;
    Split best;
    for (int order = 0; order < orders_.count(); ++order) {
      const Split split = best_of_order(s, view, order, scratch, &box);
      if (split.cost < best.cost) best = split;
    }
    return decide(s, view, box, best);
  }

  Split find_split(const Subtree& s, const View& view) {
    Box box;
    std::vector<Split> splits(view.lists.size());
    for_each_order([&](int order) {
      Scratch scratch(s.count);
      splits[static_cast<std::size_t>(order)] = best_of_order(s, view, order, scratch, &box);
    });
    Split best;
    for (const Split& split : splits) {
      if (split.cost < best.cost) best = split;
    }
    return decide(s, view, box, best);
  }

  /// Makes `s` a leaf (and returns a split with left == 0) or an inner node.
  Split decide(const Subtree& s, const View& view, const Box& box, Split best) {
    const float m = measure_(box);
    if (leaves_.is_leaf(s.count, m, best.cost)) {
      make_leaf(s, view);
      return {};
    }
    // All boxes in one line, or too large for their areas to be numbers: the measure says nothing, but order along the longest
    // axis still does.
    if (best.left == 0 || !(m > 0)) best = {best.cost, s.count / 2, orders_.first_of_axis(box.longest_axis())};
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    return best;
  }

  /// Divides every order of `s` at the split. The order that was split is divided already.
  void divide(const Subtree& s, const View& view, const Split& split, Scratch& scratch) {
    mark_sides(s, view, split);
    for (int order = 0; order < orders_.count(); ++order) {
      if (order != split.order) divide_order(s, view, order, scratch.indices());
    }
  }

  void divide(const Subtree& s, const View& view, const Split& split) {
    mark_sides(s, view, split);
    for_each_order([&](int order) {
      if (order == split.order) return;
      const auto indices = std::make_unique_for_overwrite<std::uint32_t[]>(s.count);
      divide_order(s, view, order, indices.get());
    });
  }

  void mark_sides(const Subtree& s, const View& view, const Split& split) {
    const std::uint32_t* list = ordered(s, view, split.order).list;
    for (std::uint32_t i = 0; i < split.left; ++i) view.sides[list[i]] = 0;
    for (std::uint32_t i = split.left; i < s.count; ++i) view.sides[list[i]] = 1;
  }

  void divide_order(const Subtree& s, const View& view, int order, std::uint32_t* right) {
    std::uint32_t* list = view.lists[static_cast<std::size_t>(order)] + (s.begin - view.origin);
    std::uint32_t lefts = 0;
    std::uint32_t rights = 0;
    for (std::uint32_t i = 0; i < s.count; ++i) {  // without a branch: both are written, one is kept
      const std::uint32_t index = list[i];
      const std::uint32_t side = view.sides[index];
      list[lefts] = index;
      right[rights] = index;
      lefts += 1 - side;
      rights += side;
    }
    std::copy_n(right, rights, list + lefts);
  }

  template <class F>
  void for_each_order(F&& f) {
    if (threads_ == 1) {
      for (int order = 0; order < orders_.count(); ++order) f(order);
    } else {
      parallel_for_each(orders_.lists.size(), [&](std::size_t order) { f(static_cast<int>(order)); });
    }
  }

  const M& measure_;
  LeafPolicy leaves_;
  SweepOrders& orders_;
  Bvh2& bvh_;
  int threads_;
};

}  // namespace raystudy::topdown
