// Streams of rays through wide trees. Compiled once for each instruction set (Highway's foreach_target): no include guard in the
// usual sense.

#if defined(RAYSTUDY_STREAMS_TRAVERSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_STREAMS_TRAVERSE_INL_H_
#undef RAYSTUDY_STREAMS_TRAVERSE_INL_H_
#else
#define RAYSTUDY_STREAMS_TRAVERSE_INL_H_
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "methods/packets/culling-inl.h"
#include "methods/streams/kernels.h"
#include "methods/streams/leaf-inl.h"
#include "methods/wide/in_flight-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::streams::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
namespace one = wide::HWY_NAMESPACE;
namespace many = packets::HWY_NAMESPACE;

inline constexpr std::size_t rays_in_word = 32;

/// The rays of a stream, one bit each.
template <std::size_t words>
using RayMask = std::array<std::uint32_t, words>;

/// Calls f(bit) for each bit that is set, from the lowest on.
template <class F>
HWY_INLINE void for_each_bit(std::uint32_t bits, const F& f) {
  for (; bits != 0; bits &= bits - 1) f(static_cast<unsigned>(std::countr_zero(bits)));
}

/// The planes of as many children as a vector has lanes, those first that rays of one octant enter.
template <class D>
struct ChildPlanes {
  std::array<hn::Vec<D>, 3> near, far;

  template <class Node>
  HWY_INLINE ChildPlanes(D d, const Node& node, const many::NearPlanes& sides, std::size_t lane) {
    for (std::size_t a = 0; a < 3; ++a) {
      near[a] = many::child_planes(d, node, a, sides.side[a], lane);
      far[a] = many::child_planes(d, node, a, 1 - sides.side[a], lane);
    }
  }

  /// The boxes that the ray in lane `i` of `group` meets.
  template <class Group>
  HWY_INLINE hn::Mask<D> met(D d, const Group& group, std::size_t i) const {
    const auto all = [&](const auto& row) { return hn::Set(d, row[i]); };
    const auto entered = [&](std::size_t a) { return hn::MulSub(near[a], all(group.reciprocal[a]), all(group.near_offset[a])); };
    const auto left = [&](std::size_t a) { return hn::MulSub(far[a], all(group.reciprocal[a]), all(group.far_offset[a])); };
    const auto enter = hn::Max(hn::Max(entered(0), entered(1)), hn::Max(entered(2), all(group.near)));
    const auto leave = hn::Min(hn::Min(left(0), left(1)), hn::Min(left(2), all(group.far)));
    return hn::Le(enter, leave);
  }
};

/// Depth-first traversal of a tree by many rays of one sector at a time. Each child that waits knows the rays that met its box;
/// at an inner node one ray after the other is tested against the boxes of all children, which lie in registers meanwhile.
template <class Node, std::size_t words, bool any, class Counter>
class StreamTraversal {
 public:
  static constexpr std::size_t most_rays = words * rays_in_word;

  StreamTraversal(const wide::Tree& tree, Counter& counter)
      : tree_(tree),
        counter_(counter),
        groups_(most_rays / lanes),
        depths_(any ? groups_.size() : 0),
        children_(one::stack_room(tree, width)) {
    for (auto& rays : waiting_) rays.resize(children_.size());
  }

  /// Rays of one sector, most_rays at most.
  void trace(std::span<const Ray> rays, Sector sector, std::span<Hit> hits) {
    along_ = sector.along;
    if (load(rays, sector.octant)) traverse(many::NearPlanes(sector.octant), one::RayOrder<D>(sector.octant));
    for (std::size_t g = 0; g * lanes < hits.size(); ++g) {
      many::write_hits<any>(DR(), groups_[g], std::min(lanes, hits.size() - g * lanes), hits.data() + g * lanes);
    }
  }

 private:
  static constexpr std::size_t width = Node::width;
  using D = one::FloatsOf<Node::width>;  // children side by side
  using DU = hn::Rebind<std::uint32_t, D>;
  using DR = many::FloatsOf<16>;  // rays side by side
  using Group = many::RayGroup<DR>;
  using Leaf = LeafTriangles<many::FloatsOf<8>, Group>;
  static constexpr std::size_t lanes = many::lanes_of<DR>;
  static constexpr std::size_t groups_in_word = rays_in_word / lanes;
  using Mask = RayMask<words>;
  using ChildMasks = std::array<std::array<std::uint32_t, width>, words>;  ///< by word and slot

  bool load(std::span<const Ray> rays, unsigned octant) {
    many::SlabRanges<DR> ranges(DR(), octant);
    active_.fill(0);
    std::uint32_t all = 0;
    for (std::size_t g = 0; g * lanes < rays.size(); ++g) {
      const auto these = rays.subspan(g * lanes);
      if (these.size() >= lanes) {
        many::make_ready(DR(), these.data(), tree_.slabs, groups_[g], ranges);
      } else {
        std::array<Ray, lanes> padded{};  // with rays that are not valid
        std::copy(these.begin(), these.end(), padded.begin());
        many::make_ready(DR(), padded.data(), tree_.slabs, groups_[g], ranges);
      }
      if constexpr (any) set_depths(g);
      all |= groups_[g].active;
      active_[g / groups_in_word] |= groups_[g].active << (g % groups_in_word * lanes);
    }
    return all != 0;
  }

  HWY_INLINE void set_depths(std::size_t g) {
    const DR d;
    const Group& group = groups_[g];
    const one::Depths<DR> depths(d, hn::Load(d, group.direction_along.data()), hn::Load(d, group.tmin.data()),
                                 hn::Load(d, group.t.data()));
    hn::Store(depths.low, d, depths_[g][0].data());
    hn::Store(depths.high, d, depths_[g][1].data());
    hn::Store(depths.inner_low, d, depths_[g][2].data());
    hn::Store(depths.inner_high, d, depths_[g][3].data());
  }

  HWY_INLINE void traverse(const many::NearPlanes& sides, const one::RayOrder<D>& order) {
    children_[0] = 0;
    for (std::size_t w = 0; w < words; ++w) waiting_[w][0] = active_[w];
    top_ = 1;
    while (top_ > 0) {
      --top_;
      const std::uint32_t child = children_[top_];
      Mask rays;
      std::uint32_t some = 0;
      for (std::size_t w = 0; w < words; ++w) {
        rays[w] = waiting_[w][top_] & active_[w];
        some |= rays[w];
      }
      if (some == 0) continue;
      if (WideChild::is_leaf(child)) {
        visit_leaf(child, rays);
      } else {
        visit_inner(static_cast<const Node*>(tree_.nodes)[child], rays, sides, order);
      }
    }
  }

  HWY_INLINE void visit_inner(const Node& node, const Mask& rays, const many::NearPlanes& sides, const one::RayOrder<D>& order) {
    const D d;
    const DU du;
    alignas(64) ChildMasks met;
    for (std::size_t lane = 0; lane < width; lane += hn::MaxLanes(d)) {
      const ChildPlanes<D> planes(d, node, sides, lane);
      for (std::size_t w = 0; w < words; ++w) {
        auto sum = hn::Zero(du);
        for_each_bit(rays[w], [&](unsigned bit) {
          const std::size_t ray = w * rays_in_word + bit;
          counter_.inner(ray);
          counter_.boxes(hn::MaxLanes(d));
          const auto mask = planes.met(d, groups_[ray / lanes], ray % lanes);
          sum = hn::Or(sum, hn::IfThenElseZero(hn::RebindMask(du, mask), hn::Set(du, 1U << bit)));
        });
        hn::Store(sum, du, met[w].data() + lane);
      }
    }
    const std::size_t bottom = top_;
    push(node, met, order);
    for (std::size_t i = bottom; i < top_; ++i) tree_.prefetch(children_[i]);
  }

  HWY_INLINE void push(const Node& node, const ChildMasks& met, const one::RayOrder<D>& order) {
    const std::uint32_t testable = many::testable_slots(node);
    if constexpr (hn::MaxLanes(D()) == width && HWY_TARGET <= HWY_AVX3) {
      const DU du;
      auto child = hn::LoadU(du, node.child.data());
      auto all = hn::Load(du, met[0].data());
      for (std::size_t w = 1; w < words; ++w) all = hn::Or(all, hn::Load(du, met[w].data()));
      all = hn::IfThenElseZero(hn::FirstN(du, static_cast<std::size_t>(std::popcount(testable))), all);
      const auto slots = slots_of(node, order);
      if constexpr (!any) {
        child = hn::TableLookupLanes(child, slots);
        all = hn::TableLookupLanes(all, slots);
      }
      const auto some = hn::Ne(all, hn::Zero(du));
      hn::StoreU(hn::Compress(child, some), du, children_.data() + top_);
      for (std::size_t w = 0; w < words; ++w) {
        auto rays = hn::Load(du, met[w].data());
        if constexpr (!any) rays = hn::TableLookupLanes(rays, slots);
        hn::StoreU(hn::Compress(rays, some), du, waiting_[w].data() + top_);
      }
      top_ += static_cast<std::size_t>(std::popcount(one::mask_bits(some)));
    } else {
      for (std::size_t i = 0; i < width; ++i) {
        const std::size_t slot = any ? i : node.order[order.row][(i ^ order.reversed) & (width - 1)];
        std::uint32_t some = 0;
        for (std::size_t w = 0; w < words; ++w) {
          waiting_[w][top_] = met[w][slot];
          some |= met[w][slot];
        }
        children_[top_] = node.child[slot];
        top_ += (some != 0 && ((testable >> slot) & 1U) != 0) ? 1 : 0;
      }
    }
  }

  HWY_INLINE static auto slots_of(const Node& node, const one::RayOrder<D>& order) {
    const hn::Rebind<std::uint8_t, D> d8;
    const hn::Rebind<std::int32_t, D> d32;
    const auto slots = hn::PromoteTo(d32, hn::TableLookupBytes(hn::LoadU(d8, node.order[order.row].data()), order.reversal));
    return hn::IndicesFromVec(DU(), slots);
  }

  HWY_INLINE void visit_leaf(std::uint32_t child, const Mask& rays) {
    for (std::size_t w = 0; w < words; ++w) {
      for_each_bit(rays[w], [&](unsigned bit) {
        counter_.leaf(w * rays_in_word + bit);
        counter_.triangles(WideChild::count(child));
      });
    }
    for (std::uint32_t begin = 0; begin < WideChild::count(child); begin += Leaf::lanes) {
      const Leaf leaf(tree_, child, begin, along_);
      // First all signs, then what they tell, and last what they leave to be decided: loops whose ends are the only branches.
      RayList met;
      RayList open;
      for (std::size_t w = 0; w < words; ++w) {
        for_each_bit(rays[w] & active_[w], [&](unsigned bit) {
          const std::size_t ray = w * rays_in_word + bit;
          const typename Leaf::Verdict verdict = judge(leaf, ray);
          if constexpr (any) met.add(ray, verdict.met);
          open.add(ray, verdict.met != 0 ? 0 : verdict.open);
        });
      }
      for (std::size_t i = 0; i < met.count; ++i) {
        leaf.take_any(groups_[met.ray[i] / lanes], met.ray[i] % lanes, met.triangles[i]);
        put_out(met.ray[i]);
      }
      for (std::size_t i = 0; i < open.count; ++i) {
        const bool nearer = leaf.template decide<any>(groups_[open.ray[i] / lanes], open.ray[i] % lanes, open.triangles[i]);
        if (any && nearer) put_out(open.ray[i]);
      }
    }
  }

  /// Rays with triangles of a leaf.
  struct RayList {
    std::array<std::uint32_t, most_rays> ray;
    std::array<std::uint32_t, most_rays> triangles;  ///< bits
    std::size_t count = 0;

    /// Kept only where there are triangles; without a branch.
    HWY_INLINE void add(std::size_t which, unsigned of_leaf) {
      ray[count] = static_cast<std::uint32_t>(which);
      triangles[count] = of_leaf;
      count += of_leaf != 0 ? 1 : 0;
    }
  };

  [[nodiscard]] HWY_INLINE typename Leaf::Verdict judge(const Leaf& leaf, std::size_t ray) const {
    const std::size_t g = ray / lanes;
    if constexpr (any) {
      return leaf.judge(groups_[g], depths_[g], ray % lanes);
    } else {
      return leaf.judge(groups_[g], ray % lanes);
    }
  }

  HWY_INLINE void put_out(std::size_t ray) { active_[ray / rays_in_word] &= ~(1U << (ray % rays_in_word)); }

  const wide::Tree& tree_;
  Counter& counter_;
  AlignedVector<Group> groups_;
  AlignedVector<typename Leaf::DepthRows> depths_;  ///< of each group for any hits, whose limits stay as they are
  std::size_t along_ = 0;                           ///< the rays' longest axis
  Mask active_{};                                   ///< rays that may still hit
  std::vector<std::uint32_t> children_;
  std::array<std::vector<std::uint32_t>, words> waiting_;  ///< the rays of each child that waits
  std::size_t top_ = 0;
};

/// Calls trace for the rays of each sector of each block, as many as a stream has, and puts the hits where they belong.
template <class Traversal, class Counter>
HWY_INLINE void trace_streams(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays,
                              std::span<Hit> hits, Counter& counter) {
  constexpr std::size_t size = Traversal::most_rays;
  Traversal traversal(tree, counter);
  RaySorter sorter(tree.bounds, options.sort);
  std::array<Ray, size> stream;
  std::array<Hit, size> found;
  for (std::size_t block = 0; block < rays.size(); block += options.block) {
    const auto these = rays.subspan(block, std::min<std::size_t>(options.block, rays.size() - block));
    sorter.sort(these);
    for (unsigned sector = 0; sector < Sector::count; ++sector) {
      const std::size_t end = sorter.begin(sector + 1);
      for (std::size_t begin = sorter.begin(sector); begin < end; begin += size) {
        const auto order = sorter.order().subspan(begin, std::min(size, end - begin));
        for (std::size_t i = 0; i < order.size(); ++i) stream[i] = these[order[i]];
        counter.begin(block, order);
        traversal.trace({stream.data(), order.size()}, Sector::at(sector), {found.data(), order.size()});
        for (std::size_t i = 0; i < order.size(); ++i) hits[block + order[i]] = found[i];
      }
    }
  }
}

}  // namespace raystudy::streams::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
