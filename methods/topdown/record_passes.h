#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "harness/base/parallel.h"
#include "methods/topdown/box_record.h"

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

/// pass(block, i) of blocks that together are all records, on up to `threads` threads; their results in order.
template <class Pass>
[[nodiscard]] auto pass_in_blocks(std::span<const BoxRecord> records, int threads, const Pass& pass) {
  const std::size_t n = records.size();
  const std::size_t blocks = std::clamp(n / (shared_pass / 4), std::size_t{1}, 4 * static_cast<std::size_t>(threads));
  std::vector<decltype(pass(records, blocks))> results(blocks);
  parallel_for_each(blocks, [&](std::size_t i) {
    const std::size_t begin = n * i / blocks;
    results[i] = pass(records.subspan(begin, n * (i + 1) / blocks - begin), i);
  });
  return results;
}

[[nodiscard]] inline NodeBounds bounds_of(std::span<const BoxRecord> records, int threads) {
  const auto pass = [](std::span<const BoxRecord> part, std::size_t) {
    NodeBounds bounds;
    for (const BoxRecord& record : part) bounds.extend(record);
    return bounds;
  };
  if (threads == 1 || records.size() < shared_pass) return pass(records, 0);
  NodeBounds all;
  for (const NodeBounds& part : pass_in_blocks(records, threads, pass)) all.extend(part);
  return all;
}

/// Where a node is split: triangles with (c - origin) · scale < bound, c being twice the center of the box along `axis`, go left.
struct Plane {
  int axis = 0;
  float origin = 0;
  float scale = 1;
  float bound = 0;

  [[nodiscard]] bool goes_left(const BoxRecord& r) const { return (doubled_center(r, axis) - origin) * scale < bound; }
};

[[nodiscard]] inline std::size_t count_left(std::span<const BoxRecord> records, const Plane& plane) {
  return static_cast<std::size_t>(
      std::count_if(records.begin(), records.end(), [&](const BoxRecord& r) { return plane.goes_left(r); }));
}

/// Copies the records on either side of the plane to `left` and to `right`, in order.
inline void divide(std::span<const BoxRecord> records, const Plane& plane, BoxRecord* left, BoxRecord* right) {
  std::ptrdiff_t to_left = 0;
  std::ptrdiff_t to_right = right - left;
  for (const BoxRecord& record : records) {
    // Without a branch, since which way a triangle goes cannot be predicted.
    const std::ptrdiff_t is_left = plane.goes_left(record) ? 1 : 0;
    WideBox::of(record).store(left[to_right ^ ((to_left ^ to_right) & -is_left)]);
    to_left += is_left;
    to_right += 1 - is_left;
  }
}

inline void divide(std::span<const BoxRecord> records, const Plane& plane, BoxRecord* left, BoxRecord* right, int threads) {
  if (threads == 1 || records.size() < shared_pass) return divide(records, plane, left, right);
  struct Block {
    std::span<const BoxRecord> records;
    std::size_t left;
  };
  const auto blocks = pass_in_blocks(records, threads, [&](std::span<const BoxRecord> part, std::size_t) {
    return Block{part, count_left(part, plane)};
  });
  TaskGroup tasks;
  for (const Block& block : blocks) {
    tasks.run([&plane, block, left, right] { divide(block.records, plane, left, right); });
    left += block.left;
    right += block.records.size() - block.left;
  }
  tasks.wait();
}

/// Puts the floor(n / 2) records with the lowest centers along `axis` in front of the others; equal centers by triangle.
inline void split_at_median(std::span<BoxRecord> records, int axis) {
  std::nth_element(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(records.size() / 2), records.end(),
                   [axis](const BoxRecord& a, const BoxRecord& b) {
                     const float ca = doubled_center(a, axis);
                     const float cb = doubled_center(b, axis);
                     return ca < cb || (ca == cb && a.triangle < b.triangle);
                   });
}

}  // namespace raystudy::topdown
