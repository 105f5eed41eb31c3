#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/base/aligned.h"
#include "harness/geometry/box.h"

namespace raystudy {

using Float4 = float __attribute__((vector_size(16)));

constexpr Float4 broadcast(float v) { return Float4{v, v, v, v}; }
/// Lane by lane; keeps `a` where a comparison with NaN fails, as max(float, float) does.
inline Float4 max(Float4 a, Float4 b) { return a < b ? b : a; }

/// Two boxes side by side. Each vector holds, for one axis, (-lower of the first, -lower of the second, upper of the first, upper
/// of the second): with the lower bound negated, the union of boxes is one `max` an axis for both boxes at once.
struct BoxPair {
  using Doubled = BoxPair;  ///< the box of one side, twice

  Float4 x;
  Float4 y;
  Float4 z;

  /// The same box twice.
  [[nodiscard]] static BoxPair twice(const Box& b) {
    return {Float4{-b.lower.x, -b.lower.x, b.upper.x, b.upper.x}, Float4{-b.lower.y, -b.lower.y, b.upper.y, b.upper.y},
            Float4{-b.lower.z, -b.lower.z, b.upper.z, b.upper.z}};
  }
  [[nodiscard]] Box box(std::uint32_t side) const {
    return {{-x[side], -y[side], -z[side]}, {x[side + 2], y[side + 2], z[side + 2]}};
  }
  void set(std::uint32_t side, const BoxPair& doubled) {
    x[side] = doubled.x[0], x[side + 2] = doubled.x[2];
    y[side] = doubled.y[0], y[side + 2] = doubled.y[2];
    z[side] = doubled.z[0], z[side + 2] = doubled.z[2];
  }
  /// The box of one side, twice.
  [[nodiscard]] BoxPair doubled(std::uint32_t side) const {
    if (side == 0) {
      return {__builtin_shufflevector(x, x, 0, 0, 2, 2), __builtin_shufflevector(y, y, 0, 0, 2, 2),
              __builtin_shufflevector(z, z, 0, 0, 2, 2)};
    }
    return {__builtin_shufflevector(x, x, 1, 1, 3, 3), __builtin_shufflevector(y, y, 1, 1, 3, 3),
            __builtin_shufflevector(z, z, 1, 1, 3, 3)};
  }
  [[nodiscard]] BoxPair swapped() const {
    return {__builtin_shufflevector(x, x, 1, 0, 3, 2), __builtin_shufflevector(y, y, 1, 0, 3, 2),
            __builtin_shufflevector(z, z, 1, 0, 3, 2)};
  }
  /// The union of the two boxes, twice.
  [[nodiscard]] BoxPair merged() const {
    const BoxPair other = swapped();
    return {max(x, other.x), max(y, other.y), max(z, other.z)};
  }
};

/// The unions of the first boxes and of the second boxes.
inline BoxPair united(const BoxPair& a, const BoxPair& b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
/// Whether the first boxes are the same.
inline bool same(const BoxPair& a, const BoxPair& b) {
  const auto differ = (a.x != b.x) | (a.y != b.y) | (a.z != b.z);
  return (differ[0] | differ[2]) == 0;
}

/// A binary BVH in the form that optimizers edit: siblings share a record (of 64 bytes with one box a node), so that one step of
/// a search loads few cache lines and tests two boxes at once. An inner node is named by the record of its children, and a *slot*
/// (2 · record + side) is where a node stands. Moving a subtree is moving one slot's contents.
///
/// pairs[0] is {root, unused}; records 1 … pairs.size() - 1 are the inner nodes, in no promised order once edited.
///
/// `Boxes` is what siblings have for boxes: BoxPair, or FrameBoxes with a box for each of several frames.
template <class Boxes>
class PairTreeOf {
 public:
  using Doubled = typename Boxes::Doubled;

  static constexpr std::uint32_t leaf_bit = 0x80000000U;

  struct alignas(64) Pair {
    Boxes boxes;
    /// A leaf's index into `leaves` with leaf_bit, or the record of an inner node's children.
    std::array<std::uint32_t, 2> link{};
    std::array<float, 2> measure{};  ///< m(box); left to the optimizer
  };

  struct Leaf {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  /// A node taken out of its slot.
  struct Node {
    Doubled box;
    std::uint32_t link = leaf_bit;
    float measure = 0;
    [[nodiscard]] bool is_leaf() const { return (link & leaf_bit) != 0; }
  };

  AlignedVector<Pair> pairs;
  std::vector<std::uint32_t> up;  ///< up[p]: the slot of inner node p, 0 for the root; up[0] is not used
  std::vector<Leaf> leaves;       ///< ranges of Bvh2::triangles

  /// `bvh` has two leaves at least; box_of(n) is the Doubled box of its node n. Records are laid out depth first; measures are 0.
  template <class BoxOf>
  PairTreeOf(const Bvh2& bvh, const BoxOf& box_of);
  explicit PairTreeOf(const Bvh2& bvh) requires std::is_same_v<Boxes, BoxPair>
      : PairTreeOf(bvh, [&bvh](std::uint32_t n) { return BoxPair::twice(bvh.nodes[n].box); }) {}

  [[nodiscard]] std::uint32_t inner_count() const { return static_cast<std::uint32_t>(pairs.size() - 1); }
  [[nodiscard]] std::uint32_t root() const { return pairs[0].link[0]; }
  [[nodiscard]] static bool is_leaf(std::uint32_t link) { return (link & leaf_bit) != 0; }

  [[nodiscard]] Node node(std::uint32_t slot) const {
    const Pair& pair = pairs[slot / 2];
    const std::uint32_t side = slot % 2;
    return {pair.boxes.doubled(side), pair.link[side], pair.measure[side]};
  }
  /// Puts a node into a slot, and lets it know.
  void put(std::uint32_t slot, const Node& node) {
    Pair& pair = pairs[slot / 2];
    const std::uint32_t side = slot % 2;
    pair.boxes.set(side, node.box);
    pair.link[side] = node.link;
    pair.measure[side] = node.measure;
    if (!node.is_leaf()) up[node.link] = slot;
  }

  /// Writes the tree back: records depth first with the larger child's subtree next to its parent, and `bvh.triangles` leaf by
  /// leaf in the same order. Boxes are Boxes::box(side). `bvh` is the tree this one was made from.
  void write_to(Bvh2& bvh) const;
};

using PairTree = PairTreeOf<BoxPair>;
static_assert(sizeof(PairTree::Pair) == 64);

/// Asks for all cache lines of a record.
template <class Pair>
inline void prefetch(const Pair& pair) {
  for (std::size_t line = 0; line < sizeof(Pair); line += 64) __builtin_prefetch(reinterpret_cast<const char*>(&pair) + line);
}

template <class Boxes>
template <class BoxOf>
PairTreeOf<Boxes>::PairTreeOf(const Bvh2& bvh, const BoxOf& box_of) : pairs(bvh.nodes.size() / 2), up(pairs.size()) {
  leaves.reserve(pairs.size());
  struct Task {
    std::uint32_t source;  // in bvh.nodes
    std::uint32_t slot;
  };
  std::vector<Task> stack{{0, 0}};
  std::uint32_t next = 1;
  pairs[0].boxes.set(1, box_of(0));  // a box in every slot
  while (!stack.empty()) {
    const auto [source, slot] = stack.back();
    stack.pop_back();
    const Bvh2Node& node = bvh.nodes[source];
    Node copy{box_of(source), 0, 0};
    if (node.is_leaf()) {
      copy.link = leaf_bit | static_cast<std::uint32_t>(leaves.size());
      leaves.push_back({node.first, node.count});
    } else {
      copy.link = next++;
      stack.push_back({node.first + 1, 2 * copy.link + 1});
      stack.push_back({node.first, 2 * copy.link});
    }
    put(slot, copy);
  }
}

template <class Boxes>
void PairTreeOf<Boxes>::write_to(Bvh2& bvh) const {
  std::vector<std::uint32_t> triangles;
  triangles.reserve(bvh.triangles.size());
  struct Task {
    std::uint32_t slot;
    std::uint32_t target;  // in bvh.nodes
  };
  std::vector<Task> stack{{0, 0}};
  std::uint32_t next = 2;
  while (!stack.empty()) {
    const auto [slot, target] = stack.back();
    stack.pop_back();
    const Pair& pair = pairs[slot / 2];
    const std::uint32_t link = pair.link[slot % 2];
    Bvh2Node& node = bvh.nodes[target];
    node.box = pair.boxes.box(slot % 2);
    if (is_leaf(link)) {
      const Leaf leaf = leaves[link & ~leaf_bit];
      node.first = static_cast<std::uint32_t>(triangles.size());
      node.count = leaf.count;
      for (std::uint32_t i = 0; i < leaf.count; ++i) triangles.push_back(bvh.triangles[leaf.first + i]);
    } else {
      node.first = next;
      node.count = 0;
      next += 2;
      const bool second_is_larger = pairs[link].measure[1] > pairs[link].measure[0];
      for (const std::uint32_t below : pairs[link].link) {
        if (!is_leaf(below)) prefetch(pairs[below]);
      }
      const std::uint32_t larger = second_is_larger ? 1 : 0;
      stack.push_back({2 * link + 1 - larger, node.first + 1 - larger});
      stack.push_back({2 * link + larger, node.first + larger});
    }
  }
  bvh.triangles = std::move(triangles);
}

}  // namespace raystudy
