#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/accel/accel.h"
#include "harness/base/aligned.h"
#include "harness/geometry/box.h"

namespace raystudy {

/// A node of a binary BVH. `count` > 0: a leaf over Bvh2::triangles[first, first + count). `count` == 0: an inner node whose
/// children are Bvh2::nodes[first] and [first + 1].
struct alignas(32) Bvh2Node {
  Box box;
  std::uint32_t first = 0;
  std::uint32_t count = 0;

  [[nodiscard]] bool is_leaf() const { return count > 0; }
};
static_assert(sizeof(Bvh2Node) == 32);

/// The common form of a binary BVH, which every builder of binary trees makes and every optimizer works on.
///
/// nodes[0] is the root and nodes[1] is padding, so that each pair of siblings begins at an even index and fills one 64-byte
/// cache line. A tree over no triangles has no nodes. A tree of one leaf has nodes.size() == 2. Slots that no parent refers to
/// are not allowed apart from nodes[1]: nodes.size() == 2 · leaf count.
///
/// With `duplicates` a triangle may be in several leaves (spatial splits), in each at most once. A leaf's box then need not hold
/// the whole of its triangles: of each triangle, the boxes of all the leaves that it is in cover every point.
class Bvh2 final : public Accel {
 public:
  static constexpr std::string_view kind_name = "bvh2";

  AlignedVector<Bvh2Node> nodes;         ///< 64-byte aligned
  std::vector<std::uint32_t> triangles;  ///< indices into Scene::triangles, leaf by leaf
  bool duplicates = false;               ///< set by what makes the tree; stays when leaves move whole

  [[nodiscard]] std::string_view kind() const override { return kind_name; }
  [[nodiscard]] std::size_t bytes() const override {
    return nodes.size() * sizeof(Bvh2Node) + triangles.size() * sizeof(std::uint32_t);
  }
  [[nodiscard]] bool empty() const { return nodes.empty(); }
  [[nodiscard]] std::size_t leaf_count() const { return nodes.size() / 2; }
  [[nodiscard]] std::size_t inner_count() const { return empty() ? 0 : leaf_count() - 1; }
};

}  // namespace raystudy
