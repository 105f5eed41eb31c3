#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "harness/base/radix_sort.h"
#include "harness/geometry/morton.h"
#include "harness/method/compaction.h"
#include "harness/method/registry.h"
#include "methods/ploc/clustering.h"
#include "methods/topdown/record_passes.h"
#include "methods/topdown/sweep_orders.h"

namespace raystudy::ploc {
namespace {

using topdown::BoxRecord;
using topdown::WideBox;

/// Triangles in the order of the Morton codes of their boxes' centers, equal ones in the scene's order. `room`: 32 bytes a
/// triangle.
template <class Key>
void sort_by_code(std::span<const BoxRecord> records, const MortonGrid& grid, int bits, int threads, std::byte* room,
                  AlignedRoom<std::uint32_t>& order) {
  static_assert(sizeof(Keyed<Key>) <= 16);
  const std::size_t n = records.size();
  auto* const items = reinterpret_cast<Keyed<Key>*>(room);
  parallel_for_blocks(n, 4096, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      items[i] = {static_cast<Key>(grid.code(MortonGrid::center(WideBox::of(records[i]).box()))), static_cast<std::uint32_t>(i)};
    }
  });
  radix_sort(items, items + n, n, bits, threads,
             [&order](std::size_t place, const Keyed<Key>& item) { order[place] = item.index; });
}

/// Writes `tree` to `bvh` depth first: round after round from the last to the first, so that where a pair goes is known from its
/// parent. Where that is depends on the numbers of leaves alone.
class DepthFirst {
 public:
  DepthFirst(const MergedTree& tree, const AlignedRoom<std::uint32_t>& order, int threads, Bvh2& bvh)
      : tree_(tree), order_(order), threads_(threads), bvh_(bvh), places_(order.size()) {}

  void run() {
    const auto n = static_cast<std::uint32_t>(order_.size());
    const Bvh2Node root = tree_.nodes[0];
    write(root, 0, {2, 0}, 0);
    for (std::size_t r = tree_.rounds.size(); r-- > 0;) {
      const std::uint32_t first = n - tree_.rounds[r];
      const std::uint32_t end = n - (r > 0 ? tree_.rounds[r - 1] : 0);
      parallel_for_blocks(end - first, 2048, threads_, [&](std::size_t from, std::size_t to) {
        write_pairs(first + static_cast<std::uint32_t>(from), first + static_cast<std::uint32_t>(to));
      });
    }
  }

 private:
  /// Where a pair goes, and the first triangle below it.
  struct Place {
    std::uint32_t pair;
    std::uint32_t begin;
  };

  void write_pairs(std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t p = begin; p < end; ++p) {
      __builtin_prefetch(&bvh_.nodes[places_[std::min(p + 16, end - 1)].pair], 1);
      const Place at = places_[p];
      const Bvh2Node& left = tree_.nodes[2 * p];
      const std::uint32_t below_left = left.is_leaf() ? 1 : tree_.leaves[left.first / 2];
      write(left, at.pair, {at.pair + 2, at.begin}, p);
      write(tree_.nodes[2 * p + 1], at.pair + 1, {at.pair + 2 * below_left, at.begin + below_left}, p);
    }
  }

  /// `below`: where the node's children go. Whether it has any cannot be predicted: what it has not is written to where it does
  /// no harm, to the place of its own pair, which has been read, or to that of the first triangle below it, which a later round
  /// writes.
  void write(const Bvh2Node& node, std::uint32_t slot, Place below, std::uint32_t pair) {
    const bool leaf = node.is_leaf();
    bvh_.nodes[slot] = {node.box, leaf ? below.begin : below.pair, node.count};
    bvh_.triangles[below.begin] = order_[leaf ? node.first : 0];
    places_[leaf ? pair : node.first / 2] = below;
  }

  const MergedTree& tree_;
  const AlignedRoom<std::uint32_t>& order_;
  int threads_;
  Bvh2& bvh_;
  AlignedRoom<Place> places_;  ///< by pair of `tree_`
};

class Ploc final : public Builder {
 public:
  explicit Ploc(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {
        .name = "ploc",
        .summary = "from the leaves up, merges clusters that are each other's nearest neighbours in a window of the Morton order",
        .citation =
            "Meister, Bittner: Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction, TVCG 24(3), 2018",
        .params = {integer_param("radius", 14, "r: how many places to either side of a cluster its neighbours are", 1, 1 << 16),
                   choice_param("morton_bits", {"60", "30", "63"}, "bits of the Morton codes that order the triangles"),
                   method_param("heuristic", Role::heuristic, "surface-area", "the measure of a union that makes clusters near"),
                   choice_param("leaves", {"single", "sah"}, "one triangle a leaf, or a leaf where a subtree costs more"),
                   integer_param("max_leaf_triangles", 8, "with leaves: sah, the most triangles of a leaf", 1, 1 << 20)},
        .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    const auto measure = Registry::instance().create<Heuristic>(params_.method("heuristic"))->prepare(scene, context);
    with_threads(context.threads, [&] { cluster(scene, *measure, context.threads, *bvh); });
    if (params_.text("leaves") == "sah") {
      CostModel cost = context.cost;
      cost.measure = measure;
      compact(*bvh, cost, static_cast<std::uint32_t>(params_.integer("max_leaf_triangles")));
    }
    return bvh;
  }

 private:
  /// Memory that was not used before costs more than all the searching. So the room of the merged tree first holds boxes and
  /// codes, and that of the result the clusters.
  void cluster(const Scene& scene, const Measure& measure, int threads, Bvh2& bvh) const {
    const std::size_t n = scene.triangles.size();
    const std::size_t radius = std::min(static_cast<std::size_t>(params_.integer("radius")), n);
    const std::size_t cluster_room = Clusters::room_for(n, radius);
    bvh.nodes.resize(std::max(2 * n, cluster_room * sizeof(float) / sizeof(Bvh2Node) + 1));
    bvh.triangles.resize(n);
    AlignedRoom<std::byte> room(2 * n * sizeof(Bvh2Node));
    AlignedRoom<std::uint32_t> order(n);
    Clusters clusters(n, radius, {reinterpret_cast<float*>(bvh.nodes.data()), cluster_room});
    const Box bounds = fill(scene, threads, room.data(), clusters, order);
    MergedTree tree{{reinterpret_cast<Bvh2Node*>(room.data()), 2 * n}, AlignedRoom<std::uint32_t>(n)};
    const auto run = [&](const auto& m) {
      Clustering<std::decay_t<decltype(m)>>(clusters, m, static_cast<int>(radius), threads, tree).run();
    };
    // What cannot be decided by finite areas alone goes the way of any measure, which minds infinities.
    if (std::isfinite(bounds.half_area())) {
      visit_measure(measure, run);
    } else {
      run(AnyMeasure(measure));
    }
    bvh.nodes.resize(2 * n);
    DepthFirst(tree, order, threads, bvh).run();
  }

  /// Makes every triangle a cluster, in Morton order; returns the box of all. `room`: 64 bytes a triangle.
  Box fill(const Scene& scene, int threads, std::byte* room, Clusters& clusters, AlignedRoom<std::uint32_t>& order) const {
    const std::size_t n = scene.triangles.size();
    const std::span<BoxRecord> records(reinterpret_cast<BoxRecord*>(room), n);
    topdown::fill_records(scene, threads, records);
    const Box bounds = topdown::bounds_of(records, threads).box.box();
    const int bits = std::stoi(params_.text("morton_bits"));
    const MortonGrid grid(bounds, bits / 3);
    std::byte* const items = room + n * sizeof(BoxRecord);
    if (bits == 30) {
      sort_by_code<std::uint32_t>(records, grid, bits, threads, items, order);
    } else {
      sort_by_code<std::uint64_t>(records, grid, bits, threads, items, order);
    }
    parallel_for_blocks(n, 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const BoxRecord& r = records[order[i]];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          clusters.row(axis)[i] = r.lower[axis];
          clusters.row(3 + axis)[i] = r.negated_upper[axis];
        }
        clusters.link(i) = Clusters::leaf_bit | static_cast<std::uint32_t>(i);
      }
    });
    clusters.set_count(n);
    return bounds;
  }

  Params params_;
};

const Registration<Ploc> registration;

}  // namespace
}  // namespace raystudy::ploc
