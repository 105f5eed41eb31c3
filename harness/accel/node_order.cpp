#include "harness/accel/node_order.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>

namespace raystudy {
namespace {

/// A child below a pair or node, and the surface area of the box around it (infinite where that is no number).
struct Child {
  std::uint32_t unit;
  float area;
  Child(std::uint32_t unit_, const Box& box) : unit(unit_), area(box.half_area()) {
    if (std::isnan(area)) area = std::numeric_limits<float>::infinity();
  }
};

/// The units of a Bvh2: pair p is nodes[2 p] and [2 p + 1].
struct Pairs {
  const Bvh2& bvh;
  [[nodiscard]] std::size_t count() const { return bvh.nodes.size() / 2; }
  /// The root itself is a pair with its padding; below it is one.
  void children(std::uint32_t unit, std::vector<Child>& out) const {
    out.clear();
    for (std::uint32_t n = 2 * unit; n < 2 * unit + (unit == 0 ? 1 : 2); ++n) {
      const Bvh2Node& node = bvh.nodes[n];
      if (!node.is_leaf()) out.emplace_back(node.first / 2, node.box);
    }
  }
};

template <class Node>
struct WideNodes {
  std::span<const Node> nodes;
  [[nodiscard]] std::size_t count() const { return nodes.size(); }
  void children(std::uint32_t unit, std::vector<Child>& out) const {
    out.clear();
    const Node& node = nodes[unit];
    for (std::size_t i = 0; i < node.child.size() && node.child[i] != WideChild::none; ++i) {
      if (!WideChild::is_leaf(node.child[i])) out.emplace_back(node.child[i], node.box(static_cast<int>(i)));
    }
  }
};

struct DepthFirst {
  std::vector<std::uint32_t> units;
  std::vector<float> areas;  ///< around each of them
  std::uint32_t height = 0;  ///< units on the longest way down
};

template <class Tree>
DepthFirst depth_first(const Tree& tree, bool larger_first) {
  struct Pending {
    Child child;
    std::uint32_t depth;
  };
  DepthFirst out;
  out.units.reserve(tree.count());
  out.areas.reserve(tree.count());
  constexpr float most = std::numeric_limits<float>::infinity();
  std::vector<Pending> pending{{Child(0, Box(Vec3(-most), Vec3(most))), 1}};
  std::vector<Child> children;
  while (!pending.empty()) {
    const auto [at, depth] = pending.back();
    pending.pop_back();
    out.units.push_back(at.unit);
    out.areas.push_back(at.area);
    out.height = std::max(out.height, depth);
    tree.children(at.unit, children);
    if (larger_first) {
      std::stable_sort(children.begin(), children.end(), [](const Child& a, const Child& b) { return a.area > b.area; });
    }
    std::transform(children.rbegin(), children.rend(), std::back_inserter(pending), [below = depth + 1](const Child& child) {
      return Pending{child, below};
    });
  }
  return out;
}

std::vector<std::uint32_t> by_area(const DepthFirst& all) {
  std::vector<std::uint32_t> ranks(all.units.size());
  std::iota(ranks.begin(), ranks.end(), 0U);
  std::stable_sort(ranks.begin(), ranks.end(), [&](std::uint32_t a, std::uint32_t b) { return all.areas[a] > all.areas[b]; });
  for (std::uint32_t& rank : ranks) rank = all.units[rank];
  return ranks;
}

template <class Tree>
class VanEmdeBoas {
 public:
  explicit VanEmdeBoas(const Tree& tree) : tree_(tree) { units_.reserve(tree.count()); }

  /// Puts `levels` levels of the subtree of `unit` into order; adds those below them to `below`.
  void add(std::uint32_t unit, std::uint32_t levels, std::vector<std::uint32_t>& below) {
    if (levels == 1) {
      units_.push_back(unit);
      tree_.children(unit, children_);
      for (const Child& child : children_) below.push_back(child.unit);
      return;
    }
    std::vector<std::uint32_t> middle;
    add(unit, levels / 2, middle);
    for (const std::uint32_t next : middle) add(next, levels - levels / 2, below);
  }
  [[nodiscard]] std::vector<std::uint32_t> take() { return std::move(units_); }

 private:
  const Tree& tree_;
  std::vector<std::uint32_t> units_;
  std::vector<Child> children_;
};

/// places[u]: where unit u of `tree` goes.
template <class Tree>
std::vector<std::uint32_t> places(const Tree& tree, NodeOrder order) {
  DepthFirst all = depth_first(tree, order == NodeOrder::larger_first);
  std::vector<std::uint32_t> units;
  if (order == NodeOrder::by_area) {
    units = by_area(all);
  } else if (order == NodeOrder::van_emde_boas) {
    VanEmdeBoas<Tree> recursion(tree);
    std::vector<std::uint32_t> none;
    recursion.add(0, all.height, none);
    units = recursion.take();
  } else {
    units = std::move(all.units);
  }
  std::vector<std::uint32_t> to(units.size());
  for (std::uint32_t place = 0; place < units.size(); ++place) to[units[place]] = place;
  return to;
}

}  // namespace

std::vector<std::string> node_order_names() { return {"preorder", "larger-first", "by-area", "van-emde-boas"}; }

NodeOrder node_order(const std::string& name) {
  const auto names = node_order_names();
  return static_cast<NodeOrder>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::vector<std::string> pages_names() { return {"huge", "normal"}; }

Pages pages(const std::string& name) { return name == "normal" ? Pages::normal : Pages::huge; }

void arrange(Bvh2& bvh, NodeOrder order, Pages pages) {
  if (bvh.empty()) return;
  const auto to = places(Pairs{bvh}, order);
  AlignedVector<Bvh2Node> nodes(bvh.nodes.size(), AlignedAllocator<Bvh2Node>(pages));
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
    Bvh2Node& node = nodes[2 * to[i / 2] + i % 2];
    node = bvh.nodes[i];
    if (i != 1 && !node.is_leaf()) node.first = 2 * to[node.first / 2];
  }
  bvh.nodes = std::move(nodes);
}

void arrange(WideBvh& bvh, NodeOrder order, Pages pages) {
  if (bvh.empty()) return;
  std::visit(
      [&](auto& from) {
        using Node = typename std::remove_reference_t<decltype(from)>::value_type;
        const auto to = places(WideNodes<Node>{from}, order);
        WideBvh::NodeArray<Node> nodes(from.size(), AlignedAllocator<Node>(pages));
        for (std::size_t i = 0; i < from.size(); ++i) {
          Node& node = nodes[to[i]];
          node = from[i];
          for (std::uint32_t& child : node.child) {
            if (child != WideChild::none && !WideChild::is_leaf(child)) child = to[child];
          }
        }
        from = std::move(nodes);
      },
      bvh.nodes);
  bvh.corners = AlignedVector<float>(bvh.corners.begin(), bvh.corners.end(), AlignedAllocator<float>(pages));
}

}  // namespace raystudy
