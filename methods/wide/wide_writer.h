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
    if (threads > 1) {
      std::vector<Chunk> chunks =
          divide(static_cast<std::uint32_t>(bvh_.triangles.size()) / (32 * static_cast<std::uint32_t>(threads)));
      parallel_for_indices(chunks.size(), [&](std::size_t i) {
        if (chunks[i].nodes.empty()) write_subtree(chunks[i].at, chunks[i].nodes, chunks[i].rest);
      });
      join(chunks, out);
      return;
    }
    out.triangles.reserve(bvh_.triangles.size());
    out.corners.reserve(9 * bvh_.triangles.size() + WideBvh::padding);
    nodes.reserve(bvh_.nodes.size() / (Node::width / 2));
    write_subtree({root(), no_slot, 0, 1}, nodes, out);
    out.corners.resize(9 * out.triangles.size() + WideBvh::padding, 0.0F);
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

  /// A part of the tree that is written by itself, with indices of its own: one node, or a subtree.
  struct Chunk {
    Pending at;  ///< `parent`: the chunk that the parent is the node of
    WideBvh::NodeArray<Node> nodes{};
    WideBvh rest{};  ///< triangles, corners and height
    std::size_t first_node = 0, first_triangle = 0;
  };

  /// Depth first from `top` on.
  void write_subtree(const Pending& top, WideBvh::NodeArray<Node>& nodes, WideBvh& rest) const {
    std::vector<Pending> pending{top};
    while (!pending.empty()) {
      const Pending next = pending.back();
      pending.pop_back();
      const auto index = static_cast<std::uint32_t>(nodes.size());
      if (index > 0) nodes[next.parent].child[next.slot] = index;
      nodes.emplace_back();
      write_node(nodes[index], next, index, pending, rest);
    }
  }

  /// The tree in the order in which it is written: single nodes, which are written, and subtrees of at most `most` triangles.
  [[nodiscard]] std::vector<Chunk> divide(std::uint32_t most) const {
    std::vector<Chunk> chunks;
    std::vector<Pending> pending{{root(), no_slot, 0, 1}};
    while (!pending.empty()) {
      const auto index = static_cast<std::uint32_t>(chunks.size());
      chunks.push_back({pending.back()});
      pending.pop_back();
      Chunk& chunk = chunks.back();
      if (collapse_.triangles(chunk.at.part.node) <= most) continue;
      chunk.nodes.emplace_back();
      write_node(chunk.nodes[0], chunk.at, index, pending, chunk.rest);
    }
    return chunks;
  }

  void join(std::vector<Chunk>& chunks, WideBvh& out) const {
    std::size_t node_count = 0;
    std::size_t triangle_count = 0;
    for (Chunk& chunk : chunks) {
      chunk.first_node = std::exchange(node_count, node_count + chunk.nodes.size());
      chunk.first_triangle = std::exchange(triangle_count, triangle_count + chunk.rest.triangles.size());
      out.height = std::max(out.height, chunk.rest.height);
    }
    check_triangle_count(triangle_count);
    auto& nodes = std::get<WideBvh::NodeArray<Node>>(out.nodes);
    nodes.resize(node_count);
    out.triangles.resize(triangle_count);
    out.corners.resize(9 * triangle_count + WideBvh::padding, 0.0F);
    parallel_for_indices(chunks.size(), [&](std::size_t i) {
      const Chunk& chunk = chunks[i];
      for (std::size_t n = 0; n < chunk.nodes.size(); ++n) nodes[chunk.first_node + n] = moved(chunk.nodes[n], chunk);
      std::copy(chunk.rest.triangles.begin(), chunk.rest.triangles.end(),
                out.triangles.begin() + static_cast<std::ptrdiff_t>(chunk.first_triangle));
      std::copy(chunk.rest.corners.begin(), chunk.rest.corners.end(),
                out.corners.begin() + static_cast<std::ptrdiff_t>(9 * chunk.first_triangle));
    });
    for (const Chunk& chunk : chunks) {
      if (chunk.at.parent == no_slot) continue;
      nodes[chunks[chunk.at.parent].first_node].child[chunk.at.slot] = static_cast<std::uint32_t>(chunk.first_node);
    }
  }

  /// The node with indices of the whole tree.
  static Node moved(Node node, const Chunk& chunk) {
    for (std::uint32_t& child : node.child) {
      if (child == WideChild::none) continue;
      child += static_cast<std::uint32_t>(WideChild::is_leaf(child) ? chunk.first_triangle : chunk.first_node);
    }
    return node;
  }

  /// The root as an inner node, be it a leaf or not.
  [[nodiscard]] Part root() const {
    Part part = whole(0);
    if (part.leaf) part.count = 0;
    return part;
  }

  void write_node(Node& node, const Pending& at, std::uint32_t index, std::vector<Pending>& pending, WideBvh& rest) const {
    rest.height = std::max(rest.height, at.depth);
    std::array<Part, width> parts;
    const std::uint32_t count = children(at.part, parts);
    std::stable_sort(parts.begin(), parts.begin() + count, [](const Part& a, const Part& b) { return a.measure < b.measure; });
    std::array<Box, width> boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      boxes[i] = bvh_.nodes[parts[i].node].box;
      node.child[i] = parts[i].leaf ? write_leaf(parts[i], rest) : 0;
    }
    for (std::size_t i = count; i < width; ++i) node.child[i] = WideChild::none;
    set_boxes(node, {boxes.data(), count});
    node.order = slot_orders<Node::width>({boxes.data(), count});
    for (std::uint32_t i = count; i-- > 0;) {
      if (!parts[i].leaf) pending.push_back({parts[i], index, i, at.depth + 1});
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

  std::uint32_t write_leaf(const Part& part, WideBvh& rest) const {
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
    return append_leaf(rest, scene_, {ids.data(), n});
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
