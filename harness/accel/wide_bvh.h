#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "harness/accel/accel.h"
#include "harness/base/aligned.h"
#include "harness/geometry/box.h"

namespace raystudy {

/// What a slot of a wide node refers to: an inner node, a leaf of 1 to 16 triangles, or nothing.
struct WideChild {
  static constexpr std::uint32_t leaf_bit = 0x80000000U;
  static constexpr std::uint32_t most_in_leaf = 16;
  static constexpr std::uint32_t most_first = 1U << 27U;  ///< WideBvh::triangles.size() must not be larger
  static constexpr std::uint32_t none = 0x7fffffffU;      ///< an empty slot; its box is empty, so that no ray meets it

  [[nodiscard]] static constexpr std::uint32_t leaf(std::uint32_t first, std::uint32_t count) {
    return leaf_bit | ((count - 1) << 27U) | first;
  }
  [[nodiscard]] static constexpr bool is_leaf(std::uint32_t child) { return (child & leaf_bit) != 0; }
  /// Of a leaf: where its triangles begin in WideBvh::triangles, and how many they are.
  [[nodiscard]] static constexpr std::uint32_t first(std::uint32_t child) { return child & (most_first - 1); }
  [[nodiscard]] static constexpr std::uint32_t count(std::uint32_t child) { return ((child >> 27U) & 15U) + 1; }
};

/// All slots of a node, used or not, from the farthest child to the nearest, by the centers of their boxes, for rays that go up
/// along z: row 0 for those that go up along x and y too, 1 for those that go down along x, 2 down along y, 3 down along both.
/// For rays that go down along z, the row of the opposite signs holds in reverse.
template <int W>
using SlotOrders = std::array<std::array<std::uint8_t, W>, 4>;

/// W children's boxes, plane by plane, so that one vector operation tests them all: bounds[axis][0] holds the lower planes,
/// bounds[axis][1] the upper ones. Used slots come first, by ascending measure, so that the largest comes last.
template <int W>
struct alignas(64) WideNode {
  static constexpr int width = W;
  std::array<std::array<std::array<float, W>, 2>, 3> bounds;
  std::array<std::uint32_t, W> child;
  SlotOrders<W> order;

  [[nodiscard]] Box box(int i) const {
    const auto s = static_cast<std::size_t>(i);
    return {{bounds[0][0][s], bounds[1][0][s], bounds[2][0][s]}, {bounds[0][1][s], bounds[1][1][s], bounds[2][1][s]}};
  }
  friend bool operator==(const WideNode&, const WideNode&) = default;
};

/// The same with planes of 8 bits on a grid of the node's own: plane = origin + q · 2^exponent, exactly, so that the boxes are a
/// little larger than those they stand for and never smaller (Ylitie, Karras, Laine 2017, Sec. 3.1).
template <int W>
struct alignas(W == 4 ? 16 : 64) QuantizedNode {
  static constexpr int width = W;
  std::array<float, 3> origin;
  std::array<std::int8_t, 4> exponent;  ///< of the three axes, from -126 to 127; the fourth is the number of slots used
  std::array<std::array<std::array<std::uint8_t, W>, 2>, 3> bounds;
  std::array<std::uint32_t, W> child;
  SlotOrders<W> order;

  /// Slots in use. On a grid finer than a ray's own error no box could keep rays off the others.
  [[nodiscard]] int used() const { return exponent[3]; }
  [[nodiscard]] float scale(int axis) const {
    return std::bit_cast<float>(static_cast<std::uint32_t>(exponent[static_cast<std::size_t>(axis)] + 127) << 23U);
  }
  [[nodiscard]] Box box(int i) const {
    if (i >= used()) return {};
    Box b;
    for (int axis = 0; axis < 3; ++axis) {
      const auto& planes = bounds[static_cast<std::size_t>(axis)];
      const float base = origin[static_cast<std::size_t>(axis)];
      b.lower[axis] = base + scale(axis) * static_cast<float>(planes[0][static_cast<std::size_t>(i)]);
      b.upper[axis] = base + scale(axis) * static_cast<float>(planes[1][static_cast<std::size_t>(i)]);
    }
    return b;
  }
  friend bool operator==(const QuantizedNode&, const QuantizedNode&) = default;
};

/// A BVH of 4, 8 or 16 children a node, with its triangles: what the fast tracers traverse. What `duplicates` means is said with
/// Bvh2; of 8-bit boxes, the box of a leaf is where all those on the way to it overlap.
class WideBvh final : public Accel {
 public:
  static constexpr std::string_view kind_name = "wide-bvh";

  template <class Node>
  using NodeArray = AlignedVector<Node>;
  using Nodes = std::variant<NodeArray<WideNode<4>>, NodeArray<WideNode<8>>, NodeArray<WideNode<16>>, NodeArray<QuantizedNode<4>>,
                             NodeArray<QuantizedNode<8>>, NodeArray<QuantizedNode<16>>>;

  Nodes nodes;                             ///< nodes[0] is the root, parents before children; none where the scene is empty
  AlignedVector<std::uint32_t> triangles;  ///< indices into Scene::triangles, leaf by leaf, without gaps
  AlignedVector<float> corners;            ///< see row(); padded so that 16 floats may be read from any row
  Box bounds;                              ///< of all triangles
  std::uint32_t height = 0;                ///< nodes on the longest way from the root to a leaf, the root included
  bool duplicates = false;                 ///< a triangle may be in several leaves

  /// Corners lie leaf by leaf: for a leaf of n triangles at `first`, nine rows of n floats begin at corners[9 · first]: the x of
  /// corner a of each triangle, of b, of c, then y and z alike. No padding: what a vector reads past a row belongs to the next.
  [[nodiscard]] static constexpr std::size_t row(std::uint32_t first, std::uint32_t count, int axis, int corner) {
    return std::size_t{9} * first + std::size_t{count} * static_cast<std::size_t>(3 * axis + corner);
  }
  static constexpr std::size_t padding = 16;  ///< floats at the end of `corners`

  /// Calls f with the array of nodes, as its own type.
  template <class F>
  decltype(auto) visit(F&& f) const {
    return std::visit(std::forward<F>(f), nodes);
  }

  [[nodiscard]] std::string_view kind() const override { return kind_name; }
  [[nodiscard]] std::size_t bytes() const override {
    return visit([](const auto& all) { return all.size() * sizeof(all[0]); }) + triangles.size() * sizeof(std::uint32_t) +
           corners.size() * sizeof(float);
  }
  [[nodiscard]] bool empty() const { return triangles.empty(); }
  [[nodiscard]] int width() const {
    return visit([](const auto& all) { return std::remove_cvref_t<decltype(all[0])>::width; });
  }
  [[nodiscard]] bool quantized() const { return nodes.index() >= 3; }
};

}  // namespace raystudy
