#include "harness/accel/validate_wide.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "harness/accel/tree_check.h"

namespace raystudy {
namespace {

Box overlap(const Box& a, const Box& b) { return {max(a.lower, b.lower), min(a.upper, b.upper)}; }

template <class Node>
class WideValidator {
 public:
  WideValidator(const WideBvh& bvh, const WideBvh::NodeArray<Node>& nodes, std::size_t triangles, const Scene* scene,
                std::size_t most)
      : bvh_(bvh),
        nodes_(nodes),
        scene_(scene),
        check_(triangles, scene, bvh.duplicates, most),
        has_parent_(nodes.size()),
        is_in_leaf_(bvh.triangles.size()) {}

  std::vector<std::string> run() {
    if (is_walkable()) {
      visit_all();
      check_links();
      check_.finish_leaves();
    }
    return check_.take_problems();
  }

 private:
  static constexpr bool quantized = requires(const Node& n) { n.exponent; };

  /// A node that is to be visited: the box in which a ray may come to it, and its place on the way from the root, which is at 1.
  struct Pending {
    std::uint32_t node;
    Box box;
    std::uint32_t depth;
  };

  bool is_walkable() {
    const std::size_t references = bvh_.triangles.size();
    if (bvh_.empty()) {
      check_.require_empty_scene();
      const bool bare = nodes_.empty() && bvh_.corners.empty() && bvh_.height == 0 && bvh_.bounds == Box{};
      if (!bare) check_.report("the tree has no triangles but nodes, corners, bounds or a height");
      return false;
    }
    const std::size_t corners = 9 * references + WideBvh::padding;
    if (references > WideChild::most_first) check_.report("{} triangle references, which is above 2^27", references);
    if (bvh_.corners.size() != corners) check_.report("{} floats of corners instead of {}", bvh_.corners.size(), corners);
    if (nodes_.empty()) check_.report("no nodes over {} triangle references", references);
    return references <= WideChild::most_first && bvh_.corners.size() == corners && !nodes_.empty();
  }

  void visit_all() {
    std::vector<Pending> stack{{0, bvh_.bounds, 1}};
    has_parent_[0] = true;
    std::uint32_t height = 0;
    while (!stack.empty() && !check_.is_full()) {
      const Pending next = stack.back();
      stack.pop_back();
      height = std::max(height, next.depth);
      visit(next, stack);
    }
    if (height != bvh_.height) check_.report("the height is {}; the longest way has {} nodes", bvh_.height, height);
  }

  void visit(const Pending& at, std::vector<Pending>& stack) {
    const int used = count_used(at.node);
    Box all;
    for (int i = 0; i < used; ++i) {
      all.extend(nodes_[at.node].box(i));
      visit_slot(at, i, stack);
    }
    const bool right = quantized ? all.contains(bvh_.bounds) : all == bvh_.bounds;
    if (at.node == 0 && !right) check_.report("the bounds are not those of the root's boxes");
  }

  /// How many slots may be looked at: those in front that are in use.
  int count_used(std::uint32_t n) {
    const Node& node = nodes_[n];
    const auto end = std::find(node.child.begin(), node.child.end(), WideChild::none);
    const auto used = static_cast<int>(end - node.child.begin());
    if (used == 0) check_.report("node {} has no children", n);
    check_orders(n);
    for (int i = used; i < Node::width; ++i) {
      if (node.child[static_cast<std::size_t>(i)] != WideChild::none) {
        check_.report("slot {} of node {} is used after an empty one", i, n);
      } else if (!quantized && node.box(i) != Box{}) {
        check_.report("the box of the empty slot {} of node {} is not empty", i, n);
      }
    }
    return has_good_grid(n, used) ? used : 0;
  }

  void check_orders(std::uint32_t n) {
    for (std::size_t row = 0; row < nodes_[n].order.size(); ++row) {
      auto slots = nodes_[n].order[row];
      std::sort(slots.begin(), slots.end());
      for (std::size_t i = 0; i < slots.size(); ++i) {
        if (slots[i] == i) continue;
        check_.report("row {} of the orders of node {} does not hold every slot once", row, n);
        break;
      }
    }
  }

  bool has_good_grid(std::uint32_t n, int used) {
    if constexpr (quantized) {
      const Node& node = nodes_[n];
      const auto& [x, y, z, count] = node.exponent;
      if (count != used) check_.report("node {} says that {} slots are used, not {}", n, int{count}, used);
      const bool good = std::min({x, y, z}) >= -126 && is_finite({node.origin[0], node.origin[1], node.origin[2]});
      if (!good) check_.report("the grid of node {} is not finite, or finer than 2^-126", n);
      return good && count == used;
    }
    return true;
  }

  void visit_slot(const Pending& at, int i, std::vector<Pending>& stack) {
    const Box box = nodes_[at.node].box(i);
    const bool finite = quantized || (is_finite(box.lower) && is_finite(box.upper));
    if (box.is_empty() || !finite) check_.report("the box of slot {} of node {} is empty or not finite", i, at.node);
    if (!quantized && !at.box.contains(box)) {
      check_.report("the box of slot {} of node {} is not inside that of its parent", i, at.node);
    }
    const Box reached = quantized ? overlap(at.box, box) : box;
    const std::uint32_t child = nodes_[at.node].child[static_cast<std::size_t>(i)];
    if (WideChild::is_leaf(child)) {
      visit_leaf(at.node, i, reached, WideChild::first(child), WideChild::count(child));
    } else if (child == 0 || child >= nodes_.size()) {
      check_.report("slot {} of node {} refers to node {}, not one in [1, {})", i, at.node, child, nodes_.size());
    } else if (has_parent_[child]) {
      check_.report("node {} has two parents, one of them {}", child, at.node);
    } else {
      has_parent_[child] = true;
      stack.push_back({child, reached, at.depth + 1});
    }
  }

  void visit_leaf(std::uint32_t node, int slot, const Box& box, std::uint32_t first, std::uint32_t count) {
    const auto name = [node, slot] { return fmt::format("leaf {} of node {}", slot, node); };
    if (std::size_t{first} + count > bvh_.triangles.size()) {
      check_.report("{} ends at {}, past the {} triangle references", name(), first + count, bvh_.triangles.size());
      return;
    }
    bool shares = false;
    for (std::uint32_t k = first; k < first + count; ++k) {
      shares = shares || is_in_leaf_[k];
      is_in_leaf_[k] = true;
    }
    if (shares) check_.report("{} shares triangle references with another", name());
    check_.add_leaf(name, box, {bvh_.triangles.data() + first, count});
    for (std::uint32_t k = 0; k < count; ++k) {
      if (has_own_corners(first, count, k)) continue;
      check_.report("the corners in {} are not those of triangle {}", name(), bvh_.triangles[first + k]);
    }
  }

  [[nodiscard]] bool has_own_corners(std::uint32_t first, std::uint32_t count, std::uint32_t k) const {
    const std::uint32_t t = bvh_.triangles[first + k];
    if (scene_ == nullptr || t >= scene_->triangles.size()) return true;
    for (int corner = 0; corner < 3; ++corner) {
      const Vec3 v = scene_->vertices[scene_->triangles[t][corner]];
      for (int axis = 0; axis < 3; ++axis) {
        const float found = bvh_.corners[WideBvh::row(first, count, axis, corner) + k];
        if (std::bit_cast<std::uint32_t>(found) != std::bit_cast<std::uint32_t>(v[axis])) return false;
      }
    }
    return true;
  }

  void check_links() {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!has_parent_[i]) check_.report("node {} has no parent", i);
    }
    for (std::size_t i = 0; i < is_in_leaf_.size(); ++i) {
      if (!is_in_leaf_[i]) check_.report("triangle reference {} is in no leaf", i);
    }
  }

  const WideBvh& bvh_;
  const WideBvh::NodeArray<Node>& nodes_;
  const Scene* scene_;
  TreeCheck check_;
  std::vector<bool> has_parent_;
  std::vector<bool> is_in_leaf_;
};

}  // namespace

std::vector<std::string> wide_problems(const WideBvh& bvh, std::size_t triangles, const Scene* scene, std::size_t most) {
  return bvh.visit([&]<class Node>(const WideBvh::NodeArray<Node>& nodes) {
    return WideValidator<Node>(bvh, nodes, triangles, scene, most).run();
  });
}

}  // namespace raystudy
