#include "methods/lbvh/karras.h"

#include <algorithm>
#include <atomic>
#include <vector>

#include "harness/base/parallel.h"

namespace raystudy::lbvh {
namespace {

constexpr std::size_t grain = 4096;

/// Where a node's range ends and is split. Karras compares lengths of common prefixes; here the shorter prefix is the greater
/// height.
template <class Code>
class RangeFinder {
 public:
  explicit RangeFinder(std::span<const Code> codes) : codes_(codes) {}

  struct Range {
    std::int64_t other;  ///< the end that is not the node's own place
    std::int64_t split;
  };

  [[nodiscard]] Range find(std::int64_t i) const {
    const std::int64_t d = to(i, i + 1) < to(i, i - 1) ? 1 : -1;
    const Gap outside = to(i, i - d);
    std::int64_t most = 2;
    while (to(i, i + most * d) < outside) most *= 2;
    std::int64_t length = 0;
    for (std::int64_t step = most / 2; step > 0; step /= 2) {
      if (to(i, i + (length + step) * d) < outside) length += step;
    }
    const Gap all = to(i, i + length * d);
    std::int64_t same = 0;
    for (std::int64_t step = length; step > 1;) {
      step = (step + 1) / 2;
      if (to(i, i + (same + step) * d) < all) same += step;
    }
    return {i + length * d, i + same * d + std::min<std::int64_t>(d, 0)};
  }

 private:
  [[nodiscard]] Gap to(std::int64_t i, std::int64_t j) const {
    if (j < 0 || j >= static_cast<std::int64_t>(codes_.size())) return treelet_end;
    return height(codes_.data(), static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  }

  std::span<const Code> codes_;
};

}  // namespace

template <class Code>
RadixTree::RadixTree(std::span<const Code> codes, std::uint32_t max_leaf_triangles, int threads)
    : count_(static_cast<std::uint32_t>(codes.size())), most_(max_leaf_triangles), nodes_(codes.size()), leaf_(codes.size()) {
  std::fill(leaf_.begin(), leaf_.end(), 0U);
  const RangeFinder<Code> finder(codes);
  parallel_for_blocks(count_ - 1, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto range = finder.find(static_cast<std::int64_t>(i));
      const auto [first, last] = std::minmax({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(range.other)});
      nodes_[i] = {first, last + 1, static_cast<std::uint32_t>(range.split)};
      // Of all nodes this one alone is split there.
      if (!is_leaf(first, last + 1)) leaf_[nodes_[i].split + 1] = 1;
    }
  });
  count_leaves(threads);
}

/// From where leaves begin to their numbers: sums within parts, then of the parts before.
void RadixTree::count_leaves(int threads) {
  const std::size_t parts = std::clamp<std::size_t>(count_ / grain, 1, 4 * static_cast<std::size_t>(threads));
  std::vector<std::uint32_t> sums(parts);
  const auto for_each_part = [&](const auto& f) {
    parallel_for_each(parts, [&](std::size_t part) {
      f(part, leaf_.begin() + count_ * part / parts, leaf_.begin() + count_ * (part + 1) / parts);
    });
  };
  for_each_part([&](std::size_t part, const std::uint32_t* begin, const std::uint32_t* end) {
    for (const std::uint32_t* at = begin; at != end; ++at) sums[part] += *at;
  });
  std::uint32_t sum = 0;
  for (std::uint32_t& part : sums) part = std::exchange(sum, sum + part);
  for_each_part([&](std::size_t part, std::uint32_t* begin, const std::uint32_t* end) {
    std::uint32_t number = sums[part];
    for (std::uint32_t* at = begin; at != end; ++at) *at = number += *at;
  });
  leaves_ = sum + 1;
}

/// Sets all but the box of the node at `slot`, whose range is [begin, end); as an inner node it is `nodes_[node]`.
void RadixTree::link(std::uint32_t begin, std::uint32_t end, std::uint32_t node, std::uint32_t slot, Bvh2Node* nodes,
                     std::uint32_t* parents) const {
  if (is_leaf(begin, end)) {
    nodes[slot].first = begin;
    nodes[slot].count = end - begin;
    return;
  }
  const std::uint32_t pair = pair_of(nodes_[node]);
  nodes[slot].first = 2 * pair + 2;
  nodes[slot].count = 0;
  parents[pair] = slot;
}

void RadixTree::write(const Scene& scene, std::span<const std::uint32_t> order, int threads, Bvh2Node* nodes) const {
  AlignedRoom<std::uint32_t> parents(leaves_);  // slots of the nodes that pairs are the children of
  link(0, count_, 0, 0, nodes, parents.data());
  parallel_for_blocks(count_ - 1, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Node& node = nodes_[i];
      if (is_leaf(node.begin, node.end)) continue;
      const std::uint32_t slot = 2 * pair_of(node) + 2;
      link(node.begin, node.split + 1, node.split, slot, nodes, parents.data());
      link(node.split + 1, node.end, node.split + 1, slot + 1, nodes, parents.data());
    }
  });
  const TriangleBoxes boxes(scene);
  std::vector<std::atomic<bool>> done(leaves_);  // by pair: one child is
  const auto climb = [&](std::uint32_t slot) {
    WideBox box = WideBox::empty();
    for (std::uint32_t i = 0; i < nodes[slot].count; ++i) box = united(box, boxes(order[nodes[slot].first + i]));
    for (;;) {
      nodes[slot].box = box.box();  // and no more: other threads look for leaves
      if (slot == 0) return;
      const std::uint32_t pair = slot / 2 - 1;
      if (!done[pair].exchange(true, std::memory_order_acq_rel)) return;
      box = united(box, box_of(nodes[slot ^ 1U]));
      slot = parents[pair];
    }
  };
  if (leaves_ == 1) return climb(0);
  parallel_for_blocks(leaves_ - 1, grain, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = 2 * begin + 2; slot < 2 * end + 2; ++slot) {
      if (nodes[slot].is_leaf()) climb(static_cast<std::uint32_t>(slot));
    }
  });
}

template RadixTree::RadixTree(std::span<const std::uint32_t>, std::uint32_t, int);
template RadixTree::RadixTree(std::span<const std::uint64_t>, std::uint32_t, int);

}  // namespace raystudy::lbvh
