// Packets of rays through wide trees. Compiled once for each instruction set (Highway's foreach_target): no include guard in the
// usual sense.

#if defined(RAYSTUDY_PACKETS_TRAVERSE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_PACKETS_TRAVERSE_INL_H_
#undef RAYSTUDY_PACKETS_TRAVERSE_INL_H_
#else
#define RAYSTUDY_PACKETS_TRAVERSE_INL_H_
#endif

#include <algorithm>
#include <span>
#include <vector>

#include "methods/packets/culling-inl.h"
#include "methods/packets/kernels.h"
#include "methods/packets/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::packets::HWY_NAMESPACE {

/// Groups of a packet, from the first to the last that may still meet something.
struct GroupRange {
  std::uint32_t first = 0;
  std::uint32_t last = 0;  ///< inclusive
};

/// A child that waits for its turn. Two words that no copy takes apart or joins, so that what was just stored can be loaded again
/// without delay.
struct Waiting {
  std::uint64_t key = nothing;  ///< by which children are sorted: in the upper half where the packet enters it; then the slot
  std::uint64_t place = 0;      ///< the parent in the upper half, then 16 bits each for GroupRange::first and last

  static constexpr std::uint64_t nothing = ~std::uint64_t{0};

  Waiting() = default;
  HWY_INLINE Waiting(std::uint32_t order, std::uint32_t slot, std::uint32_t parent, GroupRange range)
      : key((std::uint64_t{order} << 32U) | slot), place((std::uint64_t{parent} << 32U) | (range.first << 16U) | range.last) {}
  [[nodiscard]] HWY_INLINE float near() const { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32U)); }
  [[nodiscard]] HWY_INLINE std::uint32_t slot() const { return static_cast<std::uint32_t>(key); }
  [[nodiscard]] HWY_INLINE std::uint32_t parent() const { return static_cast<std::uint32_t>(place >> 32U); }
  [[nodiscard]] HWY_INLINE GroupRange range() const {
    return {static_cast<std::uint32_t>(place >> 16U) & 0xffffU, static_cast<std::uint32_t>(place) & 0xffffU};
  }
};

/// Which of the caller's rays those of a packet are.
struct PacketRays {
  std::size_t base = 0;
  const std::uint8_t* order = nullptr;  ///< null: one after the other
  [[nodiscard]] std::size_t operator[](std::size_t i) const { return base + (order != nullptr ? order[i] : i); }
};

/// The rays of a packet while it is traced, as far as nodes of all kinds are the same to it.
template <class D, class Counter>
class PacketState {
 public:
  using Group = RayGroup<D>;
  static constexpr std::size_t lanes = lanes_of<D>;

 protected:
  PacketState(const wide::Tree& tree, const PacketOptions& options, Counter& counter)
      : tree_(tree), options_(options), counter_(counter), groups_((options.size + lanes - 1) / lanes) {}

  /// Makes rays of one octant ready; false where none of them is valid.
  bool load(std::span<const Ray> rays, SlabRanges<D>& ranges) {
    const D d;
    count_ = (rays.size() + lanes - 1) / lanes;
    unsigned active = 0;
    for (std::size_t g = 0; g < count_; ++g) {
      const auto these = rays.subspan(g * lanes);
      if (these.size() >= lanes) {
        make_ready(d, these.data(), tree_.slabs, groups_[g], ranges);
      } else {
        std::array<Ray, lanes> padded{};  // with rays that are not valid
        std::copy(these.begin(), these.end(), padded.begin());
        make_ready(d, padded.data(), tree_.slabs, groups_[g], ranges);
      }
      active |= groups_[g].active;
    }
    near_ = hn::GetLane(hn::MinOfLanes(d, ranges.near));
    far_ = hn::GetLane(hn::MaxOfLanes(d, ranges.far));
    return active != 0;
  }

  template <bool any>
  void store(std::span<Hit> hits) const {
    for (std::size_t g = 0; g < count_; ++g) {
      write_hits<any>(D(), groups_[g], std::min(lanes, hits.size() - g * lanes), hits.data() + g * lanes);
    }
  }

  /// Narrows the range to the groups that meet the box, from the first one on, or without first_active to the last one too;
  /// `near` is where the first one enters it.
  template <class Box>
  HWY_INLINE bool find_active(const Box& box, const NearPlanes& sides, GroupRange& range, float& near) {
    const D d;
    hn::Vec<D> enter;
    for (std::uint32_t g = range.first; g <= range.last; ++g) {
      const auto met = test(g, box, sides, enter);
      if (hn::AllFalse(d, met)) continue;
      range.first = g;
      if (options_.culling == Culling::none) {
        const auto far = hn::Set(d, std::numeric_limits<float>::infinity());
        near = hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(met, enter, far)));
      }
      if (!options_.first_active) {
        while (hn::AllFalse(d, test(range.last, box, sides, enter))) --range.last;
      }
      return true;
    }
    return false;
  }

  template <bool any, class Box>
  HWY_NOINLINE void enter_leaf(std::uint32_t child, const Box& box, GroupRange range, const NearPlanes& sides) {
    const D d;
    bool nearer = false;
    for (std::uint32_t g = range.first; g <= range.last; ++g) {
      hn::Vec<D> enter;
      const unsigned rays = mask_bits(d, test(g, box, sides, enter));
      if (rays == 0) continue;
      counter_.leaf(g, rays, WideChild::count(child));
      nearer |= test_leaf<any>(d, tree_, child, rays, groups_[g]);
    }
    if (!nearer) return;
    auto far = hn::Set(d, -1);
    for (std::size_t g = 0; g < count_; ++g) far = hn::Max(far, hn::Load(d, groups_[g].far.data()));
    far_ = hn::GetLane(hn::MaxOfLanes(d, far));
  }

  const wide::Tree& tree_;
  const PacketOptions& options_;
  Counter& counter_;
  AlignedVector<Group> groups_;  ///< of the packet at hand the first count_
  std::size_t count_ = 0;
  float near_ = 0;  ///< limits of the boxes' t for all its rays
  float far_ = 0;

 private:
  template <class Box>
  HWY_INLINE hn::Mask<D> test(std::uint32_t g, const Box& box, const NearPlanes& sides, hn::Vec<D>& enter) {
    counter_.boxes(static_cast<std::uint32_t>(std::popcount(groups_[g].active)));
    return meets(D(), groups_[g], box, sides, enter);
  }
};

/// Depth-first traversal of a tree by one packet of rays of the same octant after another. A node's children are first tested
/// against the whole packet, all of them in one step (Culling); one that is left is entered as soon as a group of rays is found
/// that meets its box, and the groups before that one are out of it below ("first active", Wald, Boulos, Shirley 2007, Sec. 3.2).
template <class Node, class D, class Counter>
class PacketTraversal : PacketState<D, Counter> {
 public:
  PacketTraversal(const wide::Tree& tree, const PacketOptions& options, Query query, Counter& counter)
      : PacketState<D, Counter>(tree, options, counter),
        any_(query == Query::any_hit),
        stack_(std::size_t{tree.height} * (width - 1) + width) {}

  /// Rays of one octant, as many as a packet has at most.
  void trace(std::span<const Ray> rays, unsigned octant, std::span<Hit> hits, const PacketRays& which) {
    SlabRanges<D> ranges(D(), octant);
    if (this->load(rays, ranges)) {
      this->counter_.begin(which);
      cull_and_traverse(ranges, octant);
    }
    any_ ? this->template store<true>(hits) : this->template store<false>(hits);
  }

 private:
  static constexpr std::size_t width = Node::width;

  void cull_and_traverse(const SlabRanges<D>& ranges, unsigned octant) {
    const D d;
    const NearPlanes sides(octant);
    const Culling culling = this->options_.culling;
    if (culling == Culling::none) {
      traverse(sides, [&](std::uint32_t index, GroupRange range) { return push_met(index, range, sides); });
      return;
    }
    const PacketSlabs slabs(d, ranges);
    if (culling == Culling::frustum && ranges.bounded) {
      const std::span<const RayGroup<D>> groups(this->groups_.data(), this->count_);
      const PacketFrustum frustum(d, groups, octant, this->tree_.slabs);
      if (frustum.along < 3) {
        traverse(sides, pushing([&](const Node& node, float* enter) {
                   return cull_by_frustum(node, frustum, slabs, sides, this->near_, this->far_, enter);
                 }));
        return;
      }
    }
    traverse(sides, pushing([&](const Node& node, float* enter) {
               return cull_by_intervals(node, slabs, sides, this->near_, this->far_, enter);
             }));
  }

  /// What puts those children of a node on the stack that `cull` leaves, but for the one whose turn it is.
  template <class Cull>
  HWY_INLINE auto pushing(const Cull& cull) {
    return [this, &cull](std::uint32_t index, GroupRange range) {
      HWY_ALIGN std::array<float, width> enter;
      this->counter_.boxes(width);
      Siblings siblings(top_);
      for (unsigned met = cull(nodes()[index], enter.data()); met != 0; met &= met - 1) {
        const auto slot = static_cast<std::uint32_t>(std::countr_zero(met));
        siblings.add({order(slot, enter[slot]), slot, index, range});
        this->tree_.prefetch(nodes()[index].child[slot]);
      }
      return siblings.first;
    };
  }

  /// The same without culling: those children that some group meets.
  HWY_INLINE Waiting push_met(std::uint32_t index, GroupRange range, const NearPlanes& sides) {
    const Node& node = nodes()[index];
    Siblings siblings(top_);
    for (unsigned used = used_slots(node); used != 0; used &= used - 1) {
      const auto slot = static_cast<std::uint32_t>(std::countr_zero(used));
      GroupRange met = range;
      float near = 0;
      if (this->find_active(child_box(node, slot), sides, met, near)) siblings.add({order(slot, near), slot, index, met});
    }
    return siblings.first;
  }

  /// The nearest child first; for any hits the one of the largest measure, which has the highest slot.
  [[nodiscard]] HWY_INLINE std::uint32_t order(std::uint32_t slot, float near) const {
    return any_ ? static_cast<std::uint32_t>(width) - slot : std::bit_cast<std::uint32_t>(near);
  }

  /// The children of a node: the first by key, and the others on the stack, the last at the bottom.
  struct Siblings {
    Waiting*& top;
    Waiting* const base = top;
    Waiting first;

    HWY_INLINE explicit Siblings(Waiting*& stack) : top(stack) {}
    HWY_INLINE void add(Waiting next) {
      if (first.key == Waiting::nothing) {
        first = next;
        return;
      }
      if (next.key < first.key) std::swap(next, first);
      Waiting* at = top++;
      for (; at > base && at[-1].key < next.key; --at) {
        at->key = at[-1].key;
        at->place = at[-1].place;
      }
      at->key = next.key;
      at->place = next.place;
    }
  };

  template <class Push>
  HWY_INLINE void traverse(const NearPlanes& sides, const Push& push_children) {
    top_ = stack_.data();
    // Without culling a child's key tells where the first group that meets it enters it; others may do so nearer.
    const bool keys_are_lower_bounds = this->options_.culling != Culling::none;
    std::uint32_t index = 0;
    GroupRange range{0, static_cast<std::uint32_t>(this->count_ - 1)};
    while (true) {
      this->counter_.inner(this->groups_.data(), range);
      Waiting next = push_children(index, range);
      while (true) {
        while (next.key == Waiting::nothing || (keys_are_lower_bounds && next.near() > this->far_)) {
          if (top_ == stack_.data()) return;
          next = *--top_;
        }
        const Node& parent = nodes()[next.parent()];
        index = parent.child[next.slot()];
        const auto box = child_box(parent, next.slot());
        range = next.range();
        if (WideChild::is_leaf(index)) {
          any_ ? this->template enter_leaf<true>(index, box, range, sides)
               : this->template enter_leaf<false>(index, box, range, sides);
        } else {
          float near = 0;
          if (this->find_active(box, sides, range, near)) break;
        }
        next.key = Waiting::nothing;
      }
    }
  }

  [[nodiscard]] const Node* nodes() const { return static_cast<const Node*>(this->tree_.nodes); }

  bool any_;
  std::vector<Waiting> stack_;
  Waiting* top_ = nullptr;
};

/// Bits 0 to 2: signs of the direction's components.
HWY_INLINE unsigned octant_of(const Ray& ray) {
  const auto negative = [&](int a) { return std::bit_cast<std::uint32_t>(ray.direction[a]) >> 31U; };
  return negative(0) | (negative(1) << 1U) | (negative(2) << 2U);
}

HWY_INLINE bool share_octant(std::span<const Ray> rays) {
  const hn::FixedTag<std::uint32_t, 4> d;
  const auto direction = [&](const Ray& ray) { return hn::LoadU(d, reinterpret_cast<const std::uint32_t*>(&ray.direction)); };
  const auto first = direction(rays[0]);
  auto differ = hn::Zero(d);
  for (const Ray& ray : rays) differ = hn::Or(differ, hn::Xor(direction(ray), first));
  constexpr std::array signs_of_direction{0x80000000U, 0x80000000U, 0x80000000U, 0U};
  const auto signs = hn::LoadU(d, signs_of_direction.data());
  return hn::AllTrue(d, hn::Eq(hn::And(differ, signs), hn::Zero(d)));
}

/// Rays of several octants, sorted by octant: packets of their own.
template <class Traversal>
HWY_NOINLINE void trace_by_octant(Traversal& traversal, std::span<const Ray> rays, std::span<Hit> hits, std::size_t base) {
  constexpr std::size_t most = 256;
  std::array<std::uint32_t, 9> begin{};
  for (const Ray& ray : rays) ++begin[octant_of(ray) + 1];
  for (std::size_t o = 1; o < 9; ++o) begin[o] += begin[o - 1];
  std::array<std::uint8_t, most> order;
  std::array<Ray, most> sorted;
  std::array<Hit, most> found;
  std::array<std::uint32_t, 9> next = begin;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t at = next[octant_of(rays[i])]++;
    order[at] = static_cast<std::uint8_t>(i);
    sorted[at] = rays[i];
  }
  for (unsigned o = 0; o < 8; ++o) {
    const std::size_t count = begin[o + 1] - begin[o];
    if (count == 0) continue;
    traversal.trace({sorted.data() + begin[o], count}, o, {found.data() + begin[o], count}, {base, order.data() + begin[o]});
  }
  for (std::size_t i = 0; i < rays.size(); ++i) hits[order[i]] = found[i];
}

/// Asks for the rays of the packet after the one at hand.
HWY_INLINE void prefetch(const Ray* rays, std::size_t count) {
  constexpr std::size_t line = 64;
  for (std::size_t i = 0; i < count; i += line / sizeof(Ray)) __builtin_prefetch(rays + i);
}

template <class Traversal>
HWY_INLINE void trace_packets(Traversal& traversal, std::uint32_t size, std::span<const Ray> rays, std::span<Hit> hits) {
  for (std::size_t begin = 0; begin < rays.size(); begin += size) {
    const std::size_t count = std::min<std::size_t>(size, rays.size() - begin);
    const auto packet = rays.subspan(begin, count);
    prefetch(rays.data() + begin + count, std::min<std::size_t>(size, rays.size() - begin - count));
    if (share_octant(packet)) {
      traversal.trace(packet, octant_of(packet[0]), hits.subspan(begin, count), {begin});
    } else {
      trace_by_octant(traversal, packet, hits.subspan(begin, count), begin);
    }
  }
}

}  // namespace raystudy::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
