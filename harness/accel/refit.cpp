#include "harness/accel/refit.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <stdexcept>

#include "harness/accel/pair_tree.h"
#include "harness/base/parallel.h"

namespace raystudy {
namespace {

/// A node as two vectors: (lower x, y, z, upper x) and (upper y, z, first, count).
struct NodeVectors {
  Float4 low;
  Float4 high;
};
static_assert(sizeof(NodeVectors) == sizeof(Bvh2Node));

// Each vector is moved by itself: a node written in two halves and read as a whole, in one go, would stall the processor, which
// forwards no two stores to one load.
NodeVectors load(const Bvh2Node& node) {
  const auto* const from = reinterpret_cast<const std::byte*>(&node);
  NodeVectors v;
  std::memcpy(&v.low, from, sizeof v.low);
  std::memcpy(&v.high, from + sizeof v.low, sizeof v.high);
  return v;
}

/// Gives `node` the bounds in `low` and `high`; its links stay.
void store_box(Bvh2Node& node, Float4 low, Float4 high) {
  auto* const to = reinterpret_cast<std::byte*>(&node);
  const Float4 links = load(node).high;
  const Float4 high_and_links = __builtin_shufflevector(high, links, 0, 1, 6, 7);
  std::memcpy(to, &low, sizeof low);
  std::memcpy(to + sizeof low, &high_and_links, sizeof high_and_links);
}

Float4 min(Float4 a, Float4 b) { return b < a ? b : a; }

/// (x, y, z, z): a vertex at the array's end has nothing behind it that could be read.
Float4 load(const Vec3& p) {
  using Float2 = float __attribute__((vector_size(8)));
  Float2 xy;
  std::memcpy(&xy, &p, sizeof xy);
  const Float4 wide = __builtin_shufflevector(xy, xy, 0, 1, 0, 1);
  const Float4 z = broadcast(p.z);
  return __builtin_shufflevector(wide, z, 0, 1, 4, 4);
}

/// Pair 0 is the root and no node.
std::uint32_t nodes_in(std::uint32_t pair) { return pair == 0 ? 1 : 2; }

/// One refit: the nodes, and where the corners of their triangles are now.
struct Pass {
  Bvh2Node* nodes;
  const Triangle* corners;  ///< of Bvh2::triangles, in their order
  const Vec3* vertices;

  void leaf(Bvh2Node& node) const {
    const Triangle* triangle = corners + node.first;
    const Triangle* end = triangle + node.count;
    Float4 lower = load(vertices[(*triangle)[0]]);
    Float4 upper = lower;
    const auto extend = [&](std::uint32_t vertex) {
      const Float4 p = load(vertices[vertex]);
      lower = min(lower, p);
      upper = max(upper, p);
    };
    extend((*triangle)[1]);
    extend((*triangle)[2]);
    while (++triangle != end) {
      for (int i = 0; i < 3; ++i) extend((*triangle)[i]);
    }
    store_box(node, __builtin_shufflevector(lower, upper, 0, 1, 2, 4), __builtin_shufflevector(upper, upper, 1, 2, 1, 2));
  }

  /// Asks for the vertices of a leaf that comes later, where triangles lie leaf by leaf.
  void prefetch_vertices(const Bvh2Node& node) const {
    constexpr std::uint32_t ahead = 24;  // triangles
    if (node.first < ahead) return;
    for (const std::uint32_t vertex : corners[node.first - ahead].vertex) __builtin_prefetch(vertices + vertex);
  }

  /// From its children, which are done.
  void inner(Bvh2Node& node) const {
    const NodeVectors a = load(nodes[node.first]);
    const NodeVectors b = load(nodes[node.first + 1]);
    store_box(node, __builtin_shufflevector(min(a.low, b.low), max(a.low, b.low), 0, 1, 2, 7), max(a.high, b.high));
  }

  void pair(std::uint32_t p) const {
    for (std::uint32_t n = 2 * p; n < 2 * p + nodes_in(p); ++n) {
      if (nodes[n].is_leaf()) {
        leaf(nodes[n]);
      } else {
        inner(nodes[n]);
      }
    }
  }
};

/// From a pair of leaves up as long as the other child of the way is done too; nothing for other pairs, which are met from below.
/// Whoever comes second to a pair sees what the first has written, and leaves its count as it was before the refit. Which nodes
/// are leaves is read from `leaves`, a bit a node: a node may just be written, links and all.
void climb(const Pass& pass, std::uint32_t pair, const std::vector<std::uint32_t>& parents,
           const std::vector<std::uint64_t>& leaves, std::vector<std::atomic<std::uint8_t>>& arrivals) {
  const auto is_leaf = [&leaves](std::uint32_t n) { return ((leaves[n / 64] >> (n % 64)) & 1U) != 0; };
  for (std::uint32_t n = 2 * pair; n < 2 * pair + nodes_in(pair); ++n) {
    if (!is_leaf(n)) return;
  }
  pass.pair(pair);
  while (pair != 0) {
    const std::uint32_t parent = parents[pair];
    pass.inner(pass.nodes[parent]);
    pair = parent / 2;
    if (pair == 0) return;
    if (is_leaf(parent ^ 1U)) {
      pass.leaf(pass.nodes[parent ^ 1U]);
    } else if (arrivals[pair].fetch_xor(1, std::memory_order_acq_rel) == 0) {
      return;
    }
  }
}

/// Calls f(bit) for each bit that is set, from the highest.
template <class F>
void for_each_bit(std::uint64_t bits, const F& f) {
  while (bits != 0) {
    const auto highest = static_cast<std::size_t>(63 - std::countl_zero(bits));
    f(highest);
    bits ^= std::uint64_t{1} << highest;
  }
}

/// Asks for the pairs of 64 nodes that come two such words later in a sweep: early enough for memory, late enough for the cache.
template <class NodeAt>
void prefetch_word(const Pass& pass, std::size_t word, const NodeAt& node_at) {
  constexpr std::size_t ahead = 2;
  if (word < ahead) return;
  const std::size_t first = 64 * (word - ahead);
  for (std::size_t slot = first; slot < first + 64; slot += 2) __builtin_prefetch(pass.nodes + node_at(slot), 1);
}

/// The nodes of the pairs at [begin, end) of the depth-first order from the last on, 64 at a time: first their leaves, then their
/// inner nodes, so that the processor need not guess which a node is, nor foresee which nodes and vertices come next. `node_at`
/// gives the node in slot 2 · place + side.
template <class NodeAt>
void sweep(const Pass& pass, std::span<const std::uint64_t> leaves, std::size_t begin, std::size_t end, const NodeAt& node_at) {
  for (std::size_t slots_end = 2 * end; slots_end > 2 * begin;) {
    const std::size_t word = (slots_end - 1) / 64;
    const std::size_t slots_begin = std::max(64 * word, 2 * begin);
    prefetch_word(pass, word, node_at);
    std::uint64_t used = (~std::uint64_t{0} >> (64 * (word + 1) - slots_end)) & (~std::uint64_t{0} << (slots_begin - 64 * word));
    for_each_bit(leaves[word] & used, [&](std::size_t bit) {
      Bvh2Node& node = pass.nodes[node_at(64 * word + bit)];
      pass.prefetch_vertices(node);
      pass.leaf(node);
    });
    if (word == 0) used &= ~std::uint64_t{2};  // what is beside the root is no node
    for_each_bit(~leaves[word] & used, [&](std::size_t bit) { pass.inner(pass.nodes[node_at(64 * word + bit)]); });
    slots_end = slots_begin;
  }
}

/// Fewer pairs are not worth a task.
constexpr std::uint32_t least_pairs_a_task = 1024;
constexpr std::uint32_t tasks_a_thread = 8;

/// The pairs of a tree, parents first. Of two children the one that lies first comes first, so that the order is that of memory
/// wherever subtrees are whole there.
std::vector<std::uint32_t> depth_first(const Bvh2& bvh) {
  std::vector<std::uint32_t> order;
  order.reserve(bvh.nodes.size() / 2);
  std::vector<std::uint32_t> pending{0};
  while (!pending.empty()) {
    const std::uint32_t pair = pending.back();
    pending.pop_back();
    order.push_back(pair);
    std::size_t below = 0;
    for (std::uint32_t n = 2 * pair; n < 2 * pair + nodes_in(pair); ++n) {
      if (bvh.nodes[n].is_leaf()) continue;
      pending.push_back(bvh.nodes[n].first / 2);
      ++below;
    }
    if (below == 2 && pending[pending.size() - 2] < pending.back()) std::swap(pending[pending.size() - 2], pending.back());
  }
  return order;
}

}  // namespace

std::vector<std::string> refit_method_names() { return {"serial", "subtrees", "atomics"}; }

RefitMethod refit_method(const std::string& name) {
  const auto names = refit_method_names();
  return static_cast<RefitMethod>(std::find(names.begin(), names.end(), name) - names.begin());
}

Refitter::Refitter(const Bvh2& bvh, std::span<const Triangle> triangles, RefitMethod method, int threads)
    : method_(method), threads_(method == RefitMethod::serial ? 1 : threads), node_slots_(bvh.nodes.size()) {
  if (bvh.empty()) return;
  corners_.reserve(bvh.triangles.size());
  for (const std::uint32_t t : bvh.triangles) corners_.push_back(triangles[t]);
  if (method == RefitMethod::atomics) {
    list_parents(bvh);
    return;
  }
  std::vector<std::uint32_t> order = depth_first(bvh);
  if (method == RefitMethod::subtrees) list_subtrees(bvh, order);
  leaves_.resize((bvh.nodes.size() + 63) / 64);
  for (std::size_t slot = 0; slot < bvh.nodes.size(); ++slot) {
    if (slot == 1) continue;  // what is beside the root is no node, whatever a builder has left there
    if (bvh.nodes[2 * std::size_t{order[slot / 2]} + slot % 2].is_leaf()) leaves_[slot / 64] |= std::uint64_t{1} << (slot % 64);
  }
  if (!std::is_sorted(order.begin(), order.end())) order_ = std::move(order);
}

void Refitter::list_subtrees(const Bvh2& bvh, const std::vector<std::uint32_t>& order) {
  const auto pairs = static_cast<std::uint32_t>(order.size());
  std::vector<std::uint32_t> places(pairs);
  for (std::uint32_t place = 0; place < pairs; ++place) places[order[place]] = place;
  std::vector<std::uint32_t> ends(pairs);  // by pair: the place behind its subtree
  for (std::uint32_t place = pairs; place-- > 0;) {
    const std::uint32_t pair = order[place];
    ends[pair] = place + 1;
    for (std::uint32_t n = 2 * pair; n < 2 * pair + nodes_in(pair); ++n) {
      if (!bvh.nodes[n].is_leaf()) ends[pair] = std::max(ends[pair], ends[bvh.nodes[n].first / 2]);
    }
  }
  const std::uint32_t most = std::max(least_pairs_a_task, pairs / (tasks_a_thread * static_cast<std::uint32_t>(threads_)));
  for (std::uint32_t place = 0; place < pairs;) {
    const std::uint32_t pair = order[place];
    if (ends[pair] - place <= most) {
      subtrees_.push_back({place, ends[pair]});
      place = ends[pair];
    } else {
      above_subtrees_.push_back(pair);
      ++place;
    }
  }
}

void Refitter::list_parents(const Bvh2& bvh) {
  parents_.resize(bvh.nodes.size() / 2);
  leaves_.resize((bvh.nodes.size() + 63) / 64);
  for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n) {
    if (n == 1) continue;
    if (bvh.nodes[n].is_leaf()) {
      leaves_[n / 64] |= std::uint64_t{1} << (n % 64);
    } else {
      parents_[bvh.nodes[n].first / 2] = n;
    }
  }
  arrivals_ = std::vector<std::atomic<std::uint8_t>>(parents_.size());
}

void Refitter::refit(Bvh2& bvh, std::span<const Vec3> vertices) {
  if (bvh.nodes.size() != node_slots_ || bvh.triangles.size() != corners_.size()) {
    throw std::logic_error(fmt::format("refit: a tree of {} node slots and {} triangles; expected {} and {}", bvh.nodes.size(),
                                       bvh.triangles.size(), node_slots_, corners_.size()));
  }
  if (bvh.empty()) return;
  if (threads_ == 1) {
    refit_all(bvh, vertices);
  } else {
    with_threads(threads_, [&] { refit_all(bvh, vertices); });
  }
}

void Refitter::refit_all(Bvh2& bvh, std::span<const Vec3> vertices) {
  const Pass pass{bvh.nodes.data(), corners_.data(), vertices.data()};
  const auto pairs = static_cast<std::uint32_t>(node_slots_ / 2);
  const auto sweep = [&](Range range) {
    if (order_.empty()) {
      raystudy::sweep(pass, leaves_, range.begin, range.end, [](std::size_t slot) { return slot; });
    } else {
      raystudy::sweep(pass, leaves_, range.begin, range.end,
                      [this](std::size_t slot) { return 2 * std::size_t{order_[slot / 2]} + slot % 2; });
    }
  };
  switch (method_) {
    case RefitMethod::serial: sweep({0, pairs}); break;
    case RefitMethod::subtrees:
      parallel_for_blocks(subtrees_.size(), 1, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = end; i-- > begin;) sweep(subtrees_[i]);
      });
      for (std::size_t i = above_subtrees_.size(); i-- > 0;) pass.pair(above_subtrees_[i]);
      break;
    case RefitMethod::atomics:
      parallel_for_blocks(pairs, least_pairs_a_task, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = end; p-- > begin;) climb(pass, static_cast<std::uint32_t>(p), parents_, leaves_, arrivals_);
      });
      break;
  }
}

std::size_t Refitter::bytes() const {
  return corners_.size() * sizeof(Triangle) + (order_.size() + above_subtrees_.size() + parents_.size()) * sizeof(std::uint32_t) +
         leaves_.size() * sizeof(std::uint64_t) + subtrees_.size() * sizeof(Range) + arrivals_.size() * sizeof(arrivals_[0]);
}

}  // namespace raystudy
