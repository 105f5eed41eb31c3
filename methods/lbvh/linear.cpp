#include "methods/lbvh/linear.h"

#include <algorithm>
#include <optional>

#include "harness/base/parallel.h"
#include "methods/lbvh/hierarchy.h"
#include "methods/lbvh/karras.h"
#include "methods/lbvh/treelets.h"

namespace raystudy::lbvh {
namespace {

void new_nodes(Bvh2& bvh, std::size_t leaves) {
  bvh.nodes = AlignedVector<Bvh2Node>(2 * leaves, AlignedAllocator<Bvh2Node>::uninitialized());
}

/// Calls f(Code()) with the integer that codes need.
template <class F>
void visit_code(const Shape& shape, const F& f) {
  shape.morton_bits == 30 ? f(std::uint32_t{}) : f(std::uint64_t{});
}

[[nodiscard]] std::size_t sort_room_of(const Shape& shape, std::size_t triangles) {
  std::size_t bytes = 0;
  visit_code(shape, [&](auto code) { bytes = triangles * sort_room<decltype(code)>; });
  return bytes;
}

/// Copies what is below the roots of treelets from `nodes` to where it belongs.
void move_treelets(std::span<const Part> roots, std::span<const TreeletPlace> places, const Bvh2Node* nodes,
                   const std::uint32_t* order, int threads, Bvh2& bvh) {
  parallel_for_blocks(roots.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
    std::uint32_t leaf = begin == 0 ? 0 : roots[begin - 1].leaf + 1;
    std::uint32_t place = begin == 0 ? 0 : roots[begin - 1].place;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t slots = 2 * (places[i].leaf - leaf);
      const std::uint32_t triangles = places[i].triangle - place;
      for (std::uint32_t slot = 2 * leaf + 2; slot < 2 * roots[i].leaf + 2; ++slot) {
        Bvh2Node node = nodes[slot];
        node.first += node.is_leaf() ? triangles : slots;
        bvh.nodes[slot + slots] = node;
      }
      std::copy(order + place, order + roots[i].place, bvh.triangles.data() + places[i].triangle);
      leaf = roots[i].leaf + 1;
      place = roots[i].place;
    }
  });
}

}  // namespace

void build_linear(const Scene& scene, const Shape& shape, Construction construction, int threads, Bvh2& bvh) {
  const std::size_t n = scene.triangles.size();
  bvh.triangles.resize(n);
  // Memory that was never used costs more than sorting in it: nodes that are as many as can be lend theirs.
  static_assert(sort_room<std::uint64_t> <= 2 * sizeof(Bvh2Node));
  std::optional<AlignedRoom<std::byte>> room;
  if (shape.max_leaf_triangles == 1) {
    new_nodes(bvh, n);
  } else {
    room.emplace(sort_room_of(shape, n));
  }
  std::byte* const data = room ? room->data() : reinterpret_cast<std::byte*>(bvh.nodes.data());
  const auto make_nodes = [&](std::size_t leaves) {
    if (bvh.nodes.empty()) new_nodes(bvh, leaves);
  };
  visit_code(shape, [&](auto code) {
    const auto codes = sort_by_code<decltype(code)>(scene, shape.morton_bits, threads, data, bvh.triangles.data());
    if (construction == Construction::karras) {
      const RadixTree tree(codes, shape.max_leaf_triangles, threads);
      make_nodes(tree.leaves());
      tree.write(scene, bvh.triangles, threads, bvh.nodes.data());
    } else {
      AlignedRoom<Gap> gaps(n);
      find_gaps(codes, shape, threads, gaps.data());
      const std::vector<Block> blocks = blocks_of({gaps.data(), n}, threads);
      make_nodes(blocks.back().leaf);
      const Part root = build_parts(scene, bvh.triangles, gaps.data(), blocks, bvh.nodes.data()).front();
      set_node(bvh.nodes[0], root.box, root.first, root.count);
    }
  });
  bvh.nodes[1] = {};
}

void build_treelets(const Scene& scene, const Shape& shape, const Measure& measure, std::uint32_t bins, int threads, Bvh2& bvh) {
  const std::size_t n = scene.triangles.size();
  AlignedRoom<Gap> gaps(n);
  AlignedRoom<std::uint32_t> order(n);
  AlignedRoom<std::byte> room(sort_room_of(shape, n));
  visit_code(shape, [&](auto code) {
    find_gaps(sort_by_code<decltype(code)>(scene, shape.morton_bits, threads, room.data(), order.data()), shape, threads,
              gaps.data());
  });
  const std::vector<Block> blocks = blocks_of({gaps.data(), n}, threads);
  const std::size_t leaves = blocks.back().leaf;
  std::optional<AlignedRoom<Bvh2Node>> more_room;
  auto* nodes = reinterpret_cast<Bvh2Node*>(room.data());
  if (room.size() < 2 * leaves * sizeof(Bvh2Node)) nodes = more_room.emplace(2 * leaves).data();
  const std::vector<Part> roots = build_parts(scene, {order.data(), n}, gaps.data(), blocks, nodes);
  new_nodes(bvh, leaves);
  bvh.triangles.resize(n);
  const std::vector<TreeletPlace> places = build_over_treelets(roots, measure, bins, threads, bvh.nodes.data());
  move_treelets(roots, places, nodes, order.data(), threads, bvh);
  bvh.nodes[1] = {};
}

}  // namespace raystudy::lbvh
