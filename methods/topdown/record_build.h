#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/method/method.h"
#include "methods/topdown/box_record.h"
#include "methods/topdown/sweep_orders.h"
#include "methods/topdown/top_down.h"

namespace raystudy::topdown {

/// Twice the center of a box; the factor saves a multiplication and cancels wherever centers are compared. The fourth lane is
/// meaningless.
[[nodiscard]] inline hn::Vec<Float4> doubled_center(const WideBox& box) { return hn::Sub(box.lower(), box.negated_upper()); }
[[nodiscard]] inline float doubled_center(const BoxRecord& r, int axis) { return r.lower[axis] - r.negated_upper[axis]; }

/// The union of some triangles' boxes, and the bounds of their doubled centers.
struct NodeBounds {
  WideBox box = WideBox::empty();
  hn::Vec<Float4> first_center = hn::Set(Float4(), std::numeric_limits<float>::infinity());
  hn::Vec<Float4> last_center = hn::Set(Float4(), -std::numeric_limits<float>::infinity());

  void extend(const BoxRecord& record) {
    const WideBox b = WideBox::of(record);
    const auto center = doubled_center(b);
    box = united(box, b);
    first_center = hn::Min(first_center, center);
    last_center = hn::Max(last_center, center);
  }
  void extend(const NodeBounds& other) {
    box = united(box, other.box);
    first_center = hn::Min(first_center, other.first_center);
    last_center = hn::Max(last_center, other.last_center);
  }
};

/// Nodes of at least this many triangles share their passes over triangles among threads.
inline constexpr std::size_t shared_pass = 32768;

/// pass(block) of blocks that together are all records, on up to `threads` threads.
template <class Pass>
[[nodiscard]] auto pass_in_blocks(std::span<const BoxRecord> records, int threads, const Pass& pass) {
  const std::size_t n = records.size();
  const std::size_t blocks = std::clamp(n / (shared_pass / 4), std::size_t{1}, 4 * static_cast<std::size_t>(threads));
  std::vector<decltype(pass(records))> results(blocks);
  parallel_for_each(blocks, [&](std::size_t i) {
    const std::size_t begin = n * i / blocks;
    results[i] = pass(records.subspan(begin, n * (i + 1) / blocks - begin));
  });
  return results;
}

[[nodiscard]] inline NodeBounds bounds_of(std::span<const BoxRecord> records, int threads) {
  const auto pass = [](std::span<const BoxRecord> part) {
    NodeBounds bounds;
    for (const BoxRecord& record : part) bounds.extend(record);
    return bounds;
  };
  if (threads == 1 || records.size() < shared_pass) return pass(records);
  NodeBounds all;
  for (const NodeBounds& part : pass_in_blocks(records, threads, pass)) all.extend(part);
  return all;
}

/// Copies each record to where `left` or to where `right` points, in order, and moves that on. Without a branch, since which way
/// a triangle goes cannot be predicted.
template <class GoesLeft>
void divide_records(std::span<const BoxRecord> records, BoxRecord* left, BoxRecord* right, const GoesLeft& goes_left) {
  for (const BoxRecord& record : records) {
    const bool is_left = goes_left(record);
    WideBox::of(record).store(is_left ? *left : *right);
    left += is_left ? 1 : 0;
    right += is_left ? 0 : 1;
  }
}

/// What a splitter did with a node's records.
struct Division {
  std::uint32_t left = 0;  ///< records of the left child, which come first
  bool moved = false;      ///< they are in the spare room now
};

/// Puts the half of the records with the lower centers along `axis` in front of the others.
inline Division split_at_median(std::span<BoxRecord> records, int axis) {
  const std::size_t half = records.size() / 2;
  std::nth_element(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(half), records.end(),
                   [axis](const BoxRecord& a, const BoxRecord& b) {
                     const float ca = doubled_center(a, axis);
                     const float cb = doubled_center(b, axis);
                     return ca < cb || (ca == cb && a.triangle < b.triangle);
                   });
  return {static_cast<std::uint32_t>(half), false};
}

/// A top-down build that moves the records of triangles themselves, so that every pass over a node's triangles is sequential.
/// `Splitter` has `Division split(std::span<BoxRecord> records, BoxRecord* spare, const NodeBounds&)`, which puts the left
/// child's records before the right one's, neither none nor all of the three or more that it is given, either where they are or
/// into `spare`, which has room for as many. Each task copies it.
template <class Splitter>
class RecordBuild {
 public:
  /// `records` and `spare` hold as many; only what is in `records` counts.
  RecordBuild(const Splitter& splitter, const LeafPolicy& leaves, const Measure& measure, BoxRecords& records, BoxRecords& spare,
              Bvh2& bvh, int threads)
      : splitter_(splitter),
        leaves_(leaves),
        measure_(measure),
        rooms_{records.data(), spare.data()},
        count_(static_cast<std::uint32_t>(records.size())),
        bvh_(bvh),
        threads_(threads) {}

  /// Fills a tree over one triangle at least.
  void run() {
    bvh_.nodes.resize(std::size_t{2} * count_);
    bvh_.triangles.resize(count_);
    const Part root{{0, 2, 0, count_}, 0, bounds_of({rooms_[0], count_}, threads_)};
    TaskGroup tasks;
    tasks.run([&] { build_large(root, tasks); });
    tasks.wait();
    if (leaves_.sah) compact(bvh_);
  }

 private:
  struct Part {
    Subtree subtree;
    std::uint32_t room = 0;  ///< which of the two rooms its records are in
    NodeBounds bounds;
  };

  static constexpr std::uint32_t large = 8192;  ///< smaller subtrees are one task

  [[nodiscard]] std::span<BoxRecord> records_of(const Part& part) const {
    return {rooms_[part.room] + part.subtree.begin, part.subtree.count};
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
      if (p.subtree.count <= 2) {
        build_pair(p);
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
  }

  /// Makes the part's node and returns its children, or two parts of no triangles where it is a leaf.
  std::array<Part, 2> make_node(const Part& part, Splitter& splitter, int threads) {
    const Subtree& s = part.subtree;
    const Division division = splitter.split(records_of(part), rooms_[1 - part.room] + s.begin, part.bounds);
    const std::uint32_t room = division.moved ? 1 - part.room : part.room;
    std::array<Part, 2> children{Part{s.left(division.left), room, {}}, Part{s.right(division.left), room, {}}};
    for (Part& child : children) child.bounds = bounds_of(records_of(child), threads);
    const Box box = part.bounds.box.box();
    if (is_leaf(s, box, division.left, children[0].bounds.box.box(), children[1].bounds.box.box())) {
      make_leaf(s, box, rooms_[room] + s.begin);
      return {};
    }
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    return children;
  }

  /// One triangle, or two, which fall apart in one way only.
  void build_pair(const Part& part) {
    const Subtree& s = part.subtree;
    const Box box = part.bounds.box.box();
    const BoxRecord* records = records_of(part).data();
    if (s.count == 1) return make_leaf(s, box, records);
    const Box left = WideBox::of(records[0]).box();
    const Box right = WideBox::of(records[1]).box();
    if (is_leaf(s, box, 1, left, right)) return make_leaf(s, box, records);
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    make_leaf(s.left(1), left, records);
    make_leaf(s.right(1), right, records + 1);
  }

  /// Whether a leaf costs no more than the split into `left` triangles and the rest.
  [[nodiscard]] bool is_leaf(const Subtree& s, const Box& box, std::uint32_t left, const Box& left_box,
                             const Box& right_box) const {
    if (!leaves_.sah || s.count > leaves_.max_triangles) return false;
    const std::array<Box, 3> boxes{box, left_box, right_box};
    std::array<float, 3> m{};
    measure_.evaluate(boxes, m);
    return leaves_.is_leaf(s.count, m[0], m[1] * static_cast<float>(left) + m[2] * static_cast<float>(s.count - left));
  }

  void make_leaf(const Subtree& s, const Box& box, const BoxRecord* records) {
    for (std::uint32_t i = 0; i < s.count; ++i) bvh_.triangles[s.begin + i] = records[i].triangle;
    bvh_.nodes[s.node] = {box, s.begin, s.count};
  }

  const Splitter& splitter_;
  const LeafPolicy& leaves_;
  const Measure& measure_;
  std::array<BoxRecord*, 2> rooms_;
  std::uint32_t count_;
  Bvh2& bvh_;
  int threads_;
};

/// The whole of Builder::build for a splitter.
template <class Splitter>
std::unique_ptr<Accel> build_from_records(const Scene& scene, const BuildContext& context, const LeafPolicy& leaves,
                                          const Measure& measure, const Splitter& splitter) {
  auto bvh = std::make_unique<Bvh2>();
  if (scene.triangles.empty()) return bvh;
  with_threads(context.threads, [&] {
    BoxRecords records(scene.triangles.size());
    BoxRecords spare(scene.triangles.size());
    fill_records(scene, context.threads, records);
    RecordBuild<Splitter>(splitter, leaves, measure, records, spare, *bvh, context.threads).run();
  });
  return bvh;
}

}  // namespace raystudy::topdown
