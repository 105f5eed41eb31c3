#include "methods/lbvh/hierarchy.h"

#include <algorithm>
#include <array>

#include "harness/base/parallel.h"

namespace raystudy::lbvh {
namespace {

constexpr std::size_t least_block = 16384;

/// Takes parts in order and puts them in pairs. What cannot have its place for want of what is before the first goes out.
class Pairing {
 public:
  /// `before`: the gap before the first part.
  Pairing(Gap before, Bvh2Node* nodes, std::vector<Part>& out) : before_(before), nodes_(nodes), out_(out) {}

  void take(Part part) {
    while (depth_ > 0 && waiting_[depth_ - 1].gap < part.gap) {
      const Part& left = waiting_[--depth_];
      set_node(nodes_[2 * left.leaf + 3], part.box, part.first, part.count);
      part.box = united(left.box, part.box);
      part.first = 2 * left.leaf + 2;
      part.count = 0;
    }
    if (depth_ == 0 && before_ <= part.gap) {
      before_ = part.gap;
      out_.push_back(part);
    } else {
      set_node(nodes_[2 * part.leaf + 2], part.box, part.first, part.count);
      waiting_[depth_++] = part;
    }
  }

  /// Those that wait for what is behind the last.
  void finish() { out_.insert(out_.end(), waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(depth_)); }

 private:
  Gap before_;
  std::size_t depth_ = 0;
  Bvh2Node* nodes_;
  std::vector<Part>& out_;
  std::array<Part, leaf_end> waiting_;  ///< each of a lower gap than the one before it
};

class PartBuilder {
 public:
  PartBuilder(const Scene& scene, std::span<const std::uint32_t> order, const Gap* gaps, Bvh2Node* nodes)
      : boxes_(scene), order_(order), gaps_(gaps), nodes_(nodes) {}

  void run(const Block& block, std::vector<Part>& parts) const {
    Pairing pairing(block.begin == 0 ? treelet_end : gaps_[block.begin - 1], nodes_, parts);
    std::uint32_t leaf = block.leaf;
    for (std::size_t i = block.begin; i < block.end; ++leaf) {
      const std::size_t first = i;
      WideBox box = box_at(i);
      while (gaps_[i] < leaf_end) box = united(box, box_at(++i));
      const Gap gap = gaps_[i++];
      pairing.take({box, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(i - first), leaf,
                    static_cast<std::uint32_t>(i), gap});
    }
    pairing.finish();
  }

 private:
  /// How many places ahead a triangle is looked up, and its vertices.
  static constexpr std::size_t triangle_ahead = 32;
  static constexpr std::size_t vertices_ahead = 16;

  [[nodiscard]] WideBox box_at(std::size_t place) const {
    const std::size_t last = order_.size() - 1;
    boxes_.prefetch_triangle(order_[std::min(place + triangle_ahead, last)]);
    boxes_.prefetch_vertices(order_[std::min(place + vertices_ahead, last)]);
    return boxes_(order_[place]);
  }

  TriangleBoxes boxes_;
  std::span<const std::uint32_t> order_;
  const Gap* gaps_;
  Bvh2Node* nodes_;
};

}  // namespace

std::vector<Block> blocks_of(std::span<const Gap> gaps, int threads) {
  const std::size_t n = gaps.size();
  const std::size_t most = threads == 1 ? 1 : std::clamp<std::size_t>(n / least_block, 1, 8 * static_cast<std::size_t>(threads));
  std::vector<Block> blocks;
  for (std::size_t begin = 0; begin < n;) {
    std::size_t end = std::max(begin + 1, n * (blocks.size() + 1) / most);
    while (gaps[end - 1] < leaf_end) ++end;
    blocks.push_back({begin, end, 0});
    begin = end;
  }
  std::vector<std::uint32_t> leaves(blocks.size());
  parallel_for_each(blocks.size(), [&](std::size_t i) {
    leaves[i] = static_cast<std::uint32_t>(
        std::count_if(gaps.data() + blocks[i].begin, gaps.data() + blocks[i].end, [](Gap gap) { return gap >= leaf_end; }));
  });
  blocks.push_back({n, n, 0});
  for (std::size_t i = 0; i < leaves.size(); ++i) blocks[i + 1].leaf = blocks[i].leaf + leaves[i];
  return blocks;
}

std::vector<Part> build_parts(const Scene& scene, std::span<const std::uint32_t> order, const Gap* gaps,
                              std::span<const Block> blocks, Bvh2Node* nodes) {
  const PartBuilder builder(scene, order, gaps, nodes);
  std::vector<std::vector<Part>> parts(blocks.size() - 1);
  parallel_for_each(parts.size(), [&](std::size_t i) { builder.run(blocks[i], parts[i]); });
  if (parts.size() == 1) return std::move(parts[0]);
  std::vector<Part> roots;
  Pairing pairing(treelet_end, nodes, roots);
  for (const std::vector<Part>& some : parts) {
    for (const Part& part : some) pairing.take(part);
  }
  return roots;
}

}  // namespace raystudy::lbvh
