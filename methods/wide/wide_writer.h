#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"
#include "harness/base/parallel.h"
#include "harness/scene/scene.h"
#include "methods/wide/node_write.h"

namespace raystudy::wide {

/// Writes the wide tree that `collapse` (OptimalCollapse or GreedyCollapse) found in a binary one: nodes depth first, the
/// children of a node by descending measure, and the triangles of its leaves next to each other in the same order.
template <class Node, class Collapse>
class WideWriter {
 public:
  WideWriter(const Bvh2& bvh, const Scene& scene, const Collapse& collapse)
      : bvh_(bvh), scene_(scene), collapse_(collapse), duplicates_(bvh.triangles.size() > scene.triangles.size()) {}

  /// On the threads around the call where `threads` is not 1; the result is the same.
  void write(WideBvh& out, int threads = 1) {
    auto& nodes = out.nodes.template emplace<WideBvh::NodeArray<Node>>();
    out.duplicates = bvh_.duplicates;
    if (bvh_.empty()) return;
    out.bounds = bvh_.nodes[0].box;
    const std::size_t most = bvh_.triangles.size();
    check_triangle_count(most);
    // Written for the first time by whichever thread writes a leaf there.
    out.triangles = AlignedVector<std::uint32_t>(most, AlignedAllocator<std::uint32_t>::uninitialized());
    out.corners = AlignedVector<float>(9 * most + WideBvh::padding, AlignedAllocator<float>::uninitialized());
    Leaves leaves{out, 0, 0};
    if (threads > 1) {
      std::vector<Chunk> chunks = divide(static_cast<std::uint32_t>(most) / (32 * static_cast<std::uint32_t>(threads)), leaves);
      parallel_for_indices(chunks.size(), [&](std::size_t i) {
        if (chunks[i].nodes.empty()) write_subtree(chunks[i].at, chunks[i].nodes, chunks[i].leaves);
      });
      leaves.next = join(chunks, out);
    } else {
      write_subtree({root(), no_slot, 0, 1}, nodes, leaves);
      out.height = leaves.height;
    }
    out.triangles.resize(leaves.next);
    out.corners.resize(9 * std::size_t{leaves.next} + WideBvh::padding);
    std::fill(out.corners.end() - WideBvh::padding, out.corners.end(), 0.0F);
  }

 private:
  static constexpr std::uint32_t no_slot = 0xffffffffU;
  static constexpr std::size_t width = Node::width;

  /// A node of the binary tree, or a part of a leaf of it that holds more triangles than a wide leaf may.
  struct Part {
    std::uint32_t node = 0;
    std::uint32_t begin = 0;  ///< of a part of a leaf, in Bvh2::triangles
    std::uint32_t count = 0;  ///< 0: the whole node
    bool leaf = false;
    float measure = 0;
  };

  struct Pending {
    Part part;
    std::uint32_t parent;
    std::uint32_t slot;
    std::uint32_t depth;
  };

  [[nodiscard]] Part whole(std::uint32_t n) const {
    const Bvh2Node& node = bvh_.nodes[n];
    if (node.is_leaf() && node.count > WideChild::most_in_leaf) return {n, node.first, node.count, false, collapse_.measure(n)};
    return {n, 0, 0, collapse_.is_leaf(n), collapse_.measure(n)};
  }

  /// Where the next leaf of a part of the tree is written, and the deepest node of that part so far.
  struct Leaves {
    WideBvh& tree;
    std::uint32_t next;
    std::uint32_t height;
  };

  /// A part of the tree that is written by itself, with node indices of its own: one node, or a subtree.
  struct Chunk {
    Pending at;  ///< `parent`: the chunk that the parent is the node of
    std::uint32_t first_triangle;
    Leaves leaves;
    WideBvh::NodeArray<Node> nodes{};
    std::uint32_t first_node = 0;
    std::uint32_t gap = 0;  ///< triangles that its own have to move down by
  };

  /// Depth first from `top` on.
  void write_subtree(const Pending& top, WideBvh::NodeArray<Node>& nodes, Leaves& leaves) const {
    nodes.reserve(std::size_t{collapse_.triangles(top.part.node)} / (Node::width / 4));
    std::vector<Pending> pending{top};
    while (!pending.empty()) {
      const Pending next = pending.back();
      pending.pop_back();
      const auto index = static_cast<std::uint32_t>(nodes.size());
      if (index > 0) nodes[next.parent].child[next.slot] = index;
      nodes.emplace_back();
      write_node(nodes[index], next, index, pending, leaves);
    }
  }

  /// The tree in the order in which it is written: single nodes, which are written, and subtrees of at most `most` triangles.
  /// Each has room for as many triangles as the binary tree refers to there.
  [[nodiscard]] std::vector<Chunk> divide(std::uint32_t most, Leaves leaves) const {
    std::vector<Chunk> chunks;
    std::vector<Pending> pending{{root(), no_slot, 0, 1}};
    while (!pending.empty()) {
      const auto index = static_cast<std::uint32_t>(chunks.size());
      chunks.push_back({pending.back(), leaves.next, leaves});
      pending.pop_back();
      Chunk& chunk = chunks.back();
      const std::uint32_t count = chunk.at.part.count > 0 ? chunk.at.part.count : collapse_.triangles(chunk.at.part.node);
      if (count <= most) {
        leaves.next += count;
        continue;
      }
      chunk.nodes.emplace_back();
      write_node(chunk.nodes[0], chunk.at, index, pending, chunk.leaves);
      leaves.next = chunk.leaves.next;
    }
    return chunks;
  }

  /// Puts the chunks' nodes behind one another; returns how many triangles they have.
  std::uint32_t join(std::vector<Chunk>& chunks, WideBvh& out) const {
    std::uint32_t node_count = 0;
    std::uint32_t triangle_count = 0;
    for (Chunk& chunk : chunks) {
      chunk.first_node = std::exchange(node_count, node_count + static_cast<std::uint32_t>(chunk.nodes.size()));
      out.height = std::max(out.height, chunk.leaves.height);
      // Joined leaves of triangles with several references have left room unused.
      const std::uint32_t count = chunk.leaves.next - chunk.first_triangle;
      chunk.gap = chunk.first_triangle - triangle_count;
      if (chunk.gap > 0) move_down(out, chunk.first_triangle, count, triangle_count);
      triangle_count += count;
    }
    auto& nodes = std::get<WideBvh::NodeArray<Node>>(out.nodes);
    nodes = WideBvh::NodeArray<Node>(node_count, AlignedAllocator<Node>::uninitialized());
    parallel_for_indices(chunks.size(), [&](std::size_t i) {
      const Chunk& chunk = chunks[i];
      for (std::size_t n = 0; n < chunk.nodes.size(); ++n) nodes[chunk.first_node + n] = moved(chunk.nodes[n], chunk);
    });
    for (const Chunk& chunk : chunks) {
      if (chunk.at.parent == no_slot) continue;
      nodes[chunks[chunk.at.parent].first_node].child[chunk.at.slot] = chunk.first_node;
    }
    return triangle_count;
  }

  static void move_down(WideBvh& out, std::uint32_t from, std::uint32_t count, std::uint32_t to) {
    std::copy_n(out.triangles.begin() + from, count, out.triangles.begin() + to);
    const auto corners = [&](std::uint32_t at) { return out.corners.begin() + 9 * std::ptrdiff_t{at}; };
    std::copy(corners(from), corners(from + count), corners(to));
  }

  /// The node with indices of the whole tree.
  static Node moved(Node node, const Chunk& chunk) {
    for (std::uint32_t& child : node.child) {
      if (child == WideChild::none) continue;
      child = WideChild::is_leaf(child) ? child - chunk.gap : child + chunk.first_node;
    }
    return node;
  }

  /// The root as an inner node, be it a leaf or not.
  [[nodiscard]] Part root() const {
    Part part = whole(0);
    if (part.leaf) part.count = 0;
    return part;
  }

  void write_node(Node& node, const Pending& at, std::uint32_t index, std::vector<Pending>& pending, Leaves& leaves) const {
    leaves.height = std::max(leaves.height, at.depth);
    std::array<Part, width> parts;
    const std::uint32_t count = children(at.part, parts);
    sort_by_measure(parts.data(), count);
    std::array<Box, width> boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      boxes[i] = bvh_.nodes[parts[i].node].box;
      node.child[i] = parts[i].leaf ? append_leaf(parts[i], leaves) : 0;
    }
    for (std::size_t i = count; i < width; ++i) node.child[i] = WideChild::none;
    set_boxes(node, {boxes.data(), count});
    node.order = slot_orders<Node::width>({boxes.data(), count});
    for (std::uint32_t i = count; i-- > 0;) {
      if (!parts[i].leaf) pending.push_back({parts[i], index, i, at.depth + 1});
    }
  }

  /// By insertion, equal ones in the order they come in: for so few nothing is quicker.
  static void sort_by_measure(Part* parts, std::uint32_t count) {
    for (std::uint32_t i = 1; i < count; ++i) {
      const Part part = parts[i];
      std::uint32_t at = i;
      for (; at > 0 && part.measure < parts[at - 1].measure; --at) parts[at] = parts[at - 1];
      parts[at] = part;
    }
  }

  std::uint32_t children(const Part& part, std::array<Part, width>& out) const {
    if (part.leaf) {  // only the root
      out[0] = part;
      return 1;
    }
    if (part.count > 0) return divide_leaf(part, out);
    std::array<std::uint32_t, width> nodes;
    const std::uint32_t count = collapse_.children(part.node, nodes);
    for (std::uint32_t i = 0; i < count; ++i) out[i] = whole(nodes[i]);
    return count;
  }

  std::uint32_t divide_leaf(const Part& part, std::array<Part, width>& out) const {
    const std::uint32_t leaves = (part.count + WideChild::most_in_leaf - 1) / WideChild::most_in_leaf;
    const std::uint32_t parts = std::min<std::uint32_t>(leaves, width);
    for (std::uint32_t i = 0; i < parts; ++i) {
      const auto from = static_cast<std::uint32_t>(std::uint64_t{part.count} * i / parts);
      const auto to = static_cast<std::uint32_t>(std::uint64_t{part.count} * (i + 1) / parts);
      out[i] = {part.node, part.begin + from, to - from, to - from <= WideChild::most_in_leaf, part.measure};
    }
    return parts;
  }

  std::uint32_t append_leaf(const Part& part, Leaves& leaves) const {
    std::array<std::uint32_t, WideChild::most_in_leaf> ids;
    std::uint32_t n = part.count;
    if (n > 0) {
      std::copy_n(bvh_.triangles.begin() + part.begin, n, ids.begin());
    } else {
      n = gather(part.node, ids);
    }
    // Where triangles are referred to twice, a joined leaf needs each of them once.
    if (duplicates_) {
      std::sort(ids.begin(), ids.begin() + n);
      n = static_cast<std::uint32_t>(std::unique(ids.begin(), ids.begin() + n) - ids.begin());
    }
    return write_leaf(leaves.tree, scene_, std::exchange(leaves.next, leaves.next + n), {ids.data(), n});
  }

  std::uint32_t gather(std::uint32_t top, std::array<std::uint32_t, WideChild::most_in_leaf>& ids) const {
    std::uint32_t n = 0;
    std::array<std::uint32_t, WideChild::most_in_leaf + 1> stack{top};
    for (std::size_t size = 1; size > 0;) {
      const Bvh2Node& node = bvh_.nodes[stack[--size]];
      if (node.is_leaf()) {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) ids[n++] = bvh_.triangles[i];
      } else {
        stack[size++] = node.first + 1;
        stack[size++] = node.first;
      }
    }
    return n;
  }

  const Bvh2& bvh_;
  const Scene& scene_;
  const Collapse& collapse_;
  bool duplicates_;
};

}  // namespace raystudy::wide
