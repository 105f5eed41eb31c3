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

/// Twice the center of a box; the factor saves a multiplication and cancels wherever centers are compared. The fourth lane is 0:
/// what stands there in records looks like denormal numbers, and to multiply or divide those is very slow.
[[nodiscard]] inline hn::Vec<Float4> doubled_center(const WideBox& box) {
  alignas(16) static constexpr std::uint32_t coordinates[4] = {~0U, ~0U, ~0U, 0};
  const auto mask = hn::BitCast(Float4(), hn::Load(hn::FixedTag<std::uint32_t, 4>(), coordinates));
  return hn::And(hn::Add(box.lower, box.upper), mask);
}
[[nodiscard]] inline float doubled_center(const BoxRecord& r, int axis) { return r.lower[axis] + r.upper[axis]; }

/// The union of some triangles' boxes, and the box of their doubled centers.
struct NodeBounds {
  WideBox box = WideBox::empty();
  WideBox centers = WideBox::empty();

  void extend(const BoxRecord& record) {
    const WideBox b = WideBox::of(record);
    const auto center = doubled_center(b);
    box.lower = hn::Min(box.lower, b.lower);
    box.upper = hn::Max(box.upper, b.upper);
    centers.lower = hn::Min(centers.lower, center);
    centers.upper = hn::Max(centers.upper, center);
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
  for (const NodeBounds& part : pass_in_blocks(records, threads, pass)) {
    all = {united(all.box, part.box), united(all.centers, part.centers)};
  }
  return all;
}

/// Puts the records whose boxes go left in front of the others and returns how many they are. Without a branch, since which way a
/// triangle goes cannot be predicted.
template <class GoesLeft>
std::uint32_t partition_records(std::span<BoxRecord> records, GoesLeft&& goes_left) {
  const Float4 d;
  const auto half = [](BoxRecord& record, int i) { return reinterpret_cast<float*>(&record) + 4 * i; };
  std::uint32_t left = 0;
  for (BoxRecord& record : records) {
    // Half by half: loaded whole, what was just stored in halves would take a detour through memory.
    const auto lower = hn::Load(d, half(record, 0));
    const auto upper = hn::Load(d, half(record, 1));
    BoxRecord& other = records[left];
    hn::Store(hn::Load(d, half(other, 0)), d, half(record, 0));
    hn::Store(hn::Load(d, half(other, 1)), d, half(record, 1));
    hn::Store(lower, d, half(other, 0));
    hn::Store(upper, d, half(other, 1));
    left += goes_left(WideBox{lower, upper}) ? 1 : 0;
  }
  return left;
}

/// Puts the half of the records with the lower centers along `axis` in front of the others and returns how many they are.
inline std::uint32_t split_at_median(std::span<BoxRecord> records, int axis) {
  const std::size_t half = records.size() / 2;
  std::nth_element(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(half), records.end(),
                   [axis](const BoxRecord& a, const BoxRecord& b) {
                     const float ca = doubled_center(a, axis);
                     const float cb = doubled_center(b, axis);
                     return ca < cb || (ca == cb && a.triangle < b.triangle);
                   });
  return static_cast<std::uint32_t>(half);
}

/// A top-down build that moves the records of triangles themselves, so that every pass over a node's triangles is sequential.
/// `Splitter` has `std::uint32_t split(std::span<BoxRecord>, const NodeBounds&)`, which puts the left child's records in front
/// and returns their number, neither none nor all of the three or more that it is given. Each task copies it.
template <class Splitter>
class RecordBuild {
 public:
  RecordBuild(const Splitter& splitter, const LeafPolicy& leaves, const Measure& measure, std::span<BoxRecord> records, Bvh2& bvh,
              int threads)
      : splitter_(splitter), leaves_(leaves), measure_(measure), records_(records), bvh_(bvh), threads_(threads) {}

  /// Fills a tree over one triangle at least.
  void run() {
    const auto n = static_cast<std::uint32_t>(records_.size());
    bvh_.nodes.resize(std::size_t{2} * n);
    bvh_.triangles.resize(n);
    const Part root{{0, 2, 0, n}, bounds_of(records_, threads_)};
    TaskGroup tasks;
    tasks.run([&] { build_large(root, tasks); });
    tasks.wait();
    if (leaves_.sah) compact(bvh_);
  }

 private:
  struct Part {
    Subtree subtree;
    NodeBounds bounds;
  };

  static constexpr std::uint32_t large = 8192;  ///< smaller subtrees are one task

  void build_large(Part part, TaskGroup& tasks) {
    Splitter splitter = splitter_;
    while (part.subtree.count > large) {
      auto children = make_node(part, splitter, threads_);
      if (children[0].subtree.count == 0) return;
      if (children[1].subtree.count > children[0].subtree.count) std::swap(children[0], children[1]);
      tasks.run([this, other = children[1], &tasks] { build_large(other, tasks); });
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
    const auto records = records_.subspan(s.begin, s.count);
    const std::uint32_t left = splitter.split(records, part.bounds);
    const std::array<Part, 2> children{Part{s.left(left), bounds_of(records.first(left), threads)},
                                       Part{s.right(left), bounds_of(records.subspan(left), threads)}};
    if (make_leaf(s, part.bounds.box.box(), left, children[0].bounds.box.box(), children[1].bounds.box.box())) return {};
    bvh_.nodes[s.node] = {part.bounds.box.box(), s.pairs, 0};
    return children;
  }

  /// One triangle, or two, which fall apart in one way only.
  void build_pair(const Part& part) {
    const Subtree& s = part.subtree;
    const Box box = part.bounds.box.box();
    if (s.count == 1) return make_leaf(s, box);
    const Box left = WideBox::of(records_[s.begin]).box();
    const Box right = WideBox::of(records_[s.begin + 1]).box();
    if (make_leaf(s, box, 1, left, right)) return;
    bvh_.nodes[s.node] = {box, s.pairs, 0};
    make_leaf(s.left(1), left);
    make_leaf(s.right(1), right);
  }

  /// Makes a leaf where that costs no more than the split into `left` triangles and the rest.
  bool make_leaf(const Subtree& s, const Box& box, std::uint32_t left, const Box& left_box, const Box& right_box) {
    if (!leaves_.sah || s.count > leaves_.max_triangles) return false;
    const std::array<Box, 3> boxes{box, left_box, right_box};
    std::array<float, 3> m{};
    measure_.evaluate(boxes, m);
    const float split_cost = m[1] * static_cast<float>(left) + m[2] * static_cast<float>(s.count - left);
    if (!leaves_.is_leaf(s.count, m[0], split_cost)) return false;
    make_leaf(s, box);
    return true;
  }

  void make_leaf(const Subtree& s, const Box& box) {
    for (std::uint32_t i = s.begin; i < s.begin + s.count; ++i) bvh_.triangles[i] = records_[i].triangle;
    bvh_.nodes[s.node] = {box, s.begin, s.count};
  }

  const Splitter& splitter_;
  const LeafPolicy& leaves_;
  const Measure& measure_;
  std::span<BoxRecord> records_;
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
    fill_records(scene, context.threads, records);
    RecordBuild<Splitter>(splitter, leaves, measure, {records.data(), records.size()}, *bvh, context.threads).run();
  });
  return bvh;
}

}  // namespace raystudy::topdown
