#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/method/method.h"
#include "methods/topdown/compact.h"
#include "methods/topdown/few_boxes.h"
#include "methods/topdown/record_passes.h"
#include "methods/topdown/sweep_orders.h"
#include "methods/topdown/top_down.h"

namespace raystudy::topdown {

/// Where a splitter divides a node.
struct Split {
  Plane plane;
  std::uint32_t left = 0;  ///< triangles that go left; 0: the object median along plane.axis takes the plane's place
};

/// A top-down build that moves the records of triangles themselves, so that every pass over a node's triangles is sequential: a
/// node's records are copied from one of two rooms to the other, left and right in order. One room is the records' own. The other
/// is the slots of the subtree's own nodes, which are as large, twice as many, and not written before the subtree's records have
/// moved on.
///
/// `Splitter` has `Split split(std::span<const BoxRecord>, const NodeBounds&)` for nodes of more than `Splitter::few` triangles,
/// and with `few` > 2 also `FewSet split_few(const FewBoxes&, FewSet)`, which returns the left side of three or more. Each task
/// copies it.
template <class Splitter>
class RecordBuild {
 public:
  RecordBuild(const Splitter& splitter, const LeafPolicy& leaves, const Measure& measure, std::span<BoxRecord> records, Bvh2& bvh,
              int threads)
      : splitter_(splitter),
        leaves_(leaves),
        measure_(measure),
        surface_area_(dynamic_cast<const SurfaceArea*>(&measure)),
        records_(records),
        bvh_(bvh),
        threads_(threads) {}

  /// Fills a tree over one record at least, whose arrays are allocated: 2 n nodes and n triangles. A record may be of a part of a
  /// triangle.
  void run() {
    const auto n = static_cast<std::uint32_t>(records_.size());
    const Part root{{0, 2, 0, n}, false, bounds_of(records_, threads_)};
    TaskGroup tasks;
    tasks.run([&] { build_large(root, tasks); });
    tasks.wait();
    if (leaves_.sah) compact(bvh_, std::move(blocks_));
  }

 private:
  struct Part {
    Subtree subtree;
    bool in_nodes = false;  ///< which room its records are in
    NodeBounds bounds;      ///< where the count is above Splitter::few or leaves are larger than one
  };

  static constexpr std::uint32_t large = 8192;  ///< smaller subtrees are one task

  [[nodiscard]] std::span<BoxRecord> room(const Subtree& s, bool in_nodes) const {
    // A slot holds a record or a node, and is only ever read as what was written to it last.
    static_assert(sizeof(BoxRecord) == sizeof(Bvh2Node));
    if (!in_nodes) return {records_.data() + s.begin, s.count};
    return {reinterpret_cast<BoxRecord*>(&bvh_.nodes[s.count == 1 ? s.node : s.pairs]), s.count};
  }

  void build_large(Part part, TaskGroup& tasks) {
    Splitter splitter = splitter_;
    while (part.subtree.count > large) {
      auto children = make_node(part, splitter, threads_);
      if (children[0].subtree.count == 0) return;
      if (children[1].subtree.count > children[0].subtree.count) std::swap(children[0], children[1]);
      tasks.run([other = children[1], this, &tasks] { build_large(other, tasks); });
      part = children[0];
    }
    std::vector<Part> stack;
    const auto descend = [&](const Part& p) {
      if (p.subtree.count <= Splitter::few) {
        build_few(p.subtree, room(p.subtree, p.in_nodes).data(), splitter);
      } else {
        stack.push_back(p);
      }
    };
    descend(part);
    while (!stack.empty()) {
      const Part top = stack.back();
      stack.pop_back();
      const auto children = make_node(top, splitter, 1);
      if (children[0].subtree.count == 0) continue;
      descend(children[1]);
      descend(children[0]);
    }
    if (leaves_.sah) add_block(part.subtree);
  }

  /// Closes the gaps of a subtree that is built, while it is in near caches.
  void add_block(const Subtree& s) {
    const SubtreeBlock block{s.node, s.pairs, close_gaps(bvh_.nodes, s.node, s.pairs)};
    const std::lock_guard lock(blocks_lock_);
    blocks_.push_back(block);
  }

  /// Makes the part's node and returns its children, or two parts of no triangles where it is a leaf.
  std::array<Part, 2> make_node(const Part& part, Splitter& splitter, int threads) {
    const Subtree& s = part.subtree;
    const auto records = room(s, part.in_nodes);
    const Split split = splitter.split(records, part.bounds);
    std::array<Part, 2> children = divide(s, records, part.in_nodes, split, threads);
    for (Part& child : children) {
      if (child.subtree.count > Splitter::few || leaves_.sah) {
        child.bounds = bounds_of(room(child.subtree, child.in_nodes), threads);
      }
    }
    const Box box = part.bounds.box.box();
    if (is_leaf(s, box, children)) {
      make_leaf(s, box, records);
      return {};
    }
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    return children;
  }

  [[nodiscard]] std::array<Part, 2> divide(const Subtree& s, std::span<BoxRecord> records, bool in_nodes, const Split& split,
                                           int threads) const {
    const std::uint32_t left = split.left > 0 ? split.left : s.count / 2;
    std::array<Part, 2> children{Part{s.left(left), !in_nodes, {}}, Part{s.right(left), !in_nodes, {}}};
    if (split.left > 0) {
      topdown::divide(records, split.plane, room(children[0].subtree, !in_nodes).data(),
                      room(children[1].subtree, !in_nodes).data(), threads);
    } else {
      split_at_median(records, split.plane.axis);
      for (Part& child : children) child.in_nodes = false;
      if (in_nodes) std::copy(records.begin(), records.end(), records_.data() + s.begin);
    }
    return children;
  }

  /// The whole subtree over up to Splitter::few triangles.
  void build_few(const Subtree& s, const BoxRecord* records, Splitter& splitter) {
    FewBoxes boxes(records, s.count);
    if (s.count > 2 || leaves_.sah) {
      if (surface_area_ != nullptr) {
        boxes.evaluate(*surface_area_, s.count);
      } else {
        boxes.evaluate(measure_, s.count);
      }
    }
    build_few(s, (1U << s.count) - 1, boxes, splitter);
  }

  void build_few(const Subtree& s, FewSet set, const FewBoxes& boxes, Splitter& splitter) {
    const Box box = WideBox::of(boxes.of(set)).box();
    if (s.count > 1) {
      FewSet left = set & (0U - set);
      if constexpr (Splitter::few > 2) {
        if (s.count > 2) left = splitter.split_few(boxes, set);
      }
      const FewSet right = set ^ left;
      const auto left_count = static_cast<std::uint32_t>(std::popcount(left));
      if (!leaves_.sah || !leaves_.is_leaf(s.count, boxes.measure(set), boxes.weight(left) + boxes.weight(right))) {
        bvh_.nodes[s.node] = {box, s.pairs, 0};
        build_few(s.left(left_count), left, boxes, splitter);
        build_few(s.right(left_count), right, boxes, splitter);
        return;
      }
    }
    std::uint32_t at = s.begin;
    for (FewSet rest = set; rest != 0; rest &= rest - 1) bvh_.triangles[at++] = boxes.of(rest & (0U - rest)).triangle;
    bvh_.nodes[s.node] = {box, s.begin, s.count};
  }

  /// Whether a leaf costs no more than the split into `children`.
  [[nodiscard]] bool is_leaf(const Subtree& s, const Box& box, const std::array<Part, 2>& children) const {
    if (!leaves_.sah || s.count > leaves_.max_triangles) return false;
    const std::array<Box, 3> boxes{box, children[0].bounds.box.box(), children[1].bounds.box.box()};
    std::array<float, 3> m{};
    measure_.evaluate(boxes, m);
    const auto weight = [&](std::size_t i) { return m[i + 1] * static_cast<float>(children[i].subtree.count); };
    return leaves_.is_leaf(s.count, m[0], weight(0) + weight(1));
  }

  void make_leaf(const Subtree& s, const Box& box, std::span<const BoxRecord> records) {
    for (std::uint32_t i = 0; i < s.count; ++i) bvh_.triangles[s.begin + i] = records[i].triangle;
    bvh_.nodes[s.node] = {box, s.begin, s.count};
  }

  const Splitter& splitter_;
  const LeafPolicy& leaves_;
  const Measure& measure_;
  const SurfaceArea* surface_area_;  ///< measure_, if it is that
  std::span<BoxRecord> records_;
  Bvh2& bvh_;
  int threads_;
  std::mutex blocks_lock_;
  std::vector<SubtreeBlock> blocks_;  ///< where leaves leave gaps: the subtrees that are one task
};

/// The whole of Builder::build for a splitter.
template <class Splitter>
std::unique_ptr<Accel> build_from_records(const Scene& scene, const BuildContext& context, const LeafPolicy& leaves,
                                          const Measure& measure, const Splitter& splitter) {
  auto bvh = std::make_unique<Bvh2>();
  if (scene.triangles.empty()) return bvh;
  with_threads(context.threads, [&] {
    const std::size_t n = scene.triangles.size();
    BoxRecords records(n);
    fill_records(scene, context.threads, records);
    bvh->nodes = AlignedVector<Bvh2Node>(2 * n, AlignedAllocator<Bvh2Node>::uninitialized());
    bvh->nodes[1] = {};
    bvh->triangles.resize(n);
    RecordBuild<Splitter>(splitter, leaves, measure, {records.data(), n}, *bvh, context.threads).run();
  });
  return bvh;
}

}  // namespace raystudy::topdown
