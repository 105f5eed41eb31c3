// Traversal of wide trees by many rays at a time, compiled once for each instruction set (see traverse-inl.h).

#if defined(RAYSTUDY_WIDE_IN_FLIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYSTUDY_WIDE_IN_FLIGHT_INL_H_
#undef RAYSTUDY_WIDE_IN_FLIGHT_INL_H_
#else
#define RAYSTUDY_WIDE_IN_FLIGHT_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "methods/wide/traverse-inl.h"

HWY_BEFORE_NAMESPACE();
namespace raystudy::wide::HWY_NAMESPACE {

/// How a ray orders the slots of nodes (SlotOrders): by which row, and whether from its end.
template <class D>
struct RayOrder {
  using D8 = hn::Rebind<std::uint8_t, D>;
  std::size_t row;
  std::size_t reversed;  ///< 0, or all ones
  hn::Vec<D8> reversal;

  /// `octant`: bit i where the ray goes down along axis i.
  HWY_INLINE explicit RayOrder(unsigned octant) {
    const bool down = (octant & 4U) != 0;
    row = (down ? ~octant : octant) & 3U;
    reversed = down ? ~std::size_t{0} : 0;
    const auto forward = hn::Iota(D8(), 0);
    reversal = hn::Xor(forward, hn::Set(D8(), static_cast<std::uint8_t>(down ? hn::MaxLanes(D8()) - 1 : 0)));
  }
};

/// Writes the children that are met to the top of the stack, the one to go on with last, and returns how many they are. For a
/// closest hit that is the nearest by the slots' order, for any hit the one of largest area. How many children are met cannot be
/// predicted, so that all are written at once by a compressing store.
template <bool any, class D, class Node>
HWY_INLINE std::size_t push_met(D d, const Node& node, const SlabVectors<D>& slabs, const RayOrder<D>& order, hn::Vec<D> tmin,
                                hn::Vec<D> tmax, std::uint32_t* children, float* nears) {
  if constexpr (hn::MaxLanes(D()) == Node::width) {
    const hn::Rebind<std::uint32_t, D> du32;
    const hn::Rebind<std::int32_t, D> d32;
    Slabs<D> boxes = test_boxes(d, node, 0, slabs, tmin, tmax);
    auto child = hn::LoadU(du32, node.child.data());
    if constexpr (!any) {
      const hn::Rebind<std::uint8_t, D> d8;
      const auto slots = hn::PromoteTo(d32, hn::TableLookupBytes(hn::LoadU(d8, node.order[order.row].data()), order.reversal));
      boxes.enter = hn::TableLookupLanes(boxes.enter, hn::IndicesFromVec(d, slots));
      boxes.leave = hn::TableLookupLanes(boxes.leave, hn::IndicesFromVec(d, slots));
      child = hn::TableLookupLanes(child, hn::IndicesFromVec(du32, slots));
    }
    const auto met = boxes.met();
    hn::StoreU(hn::Compress(child, hn::RebindMask(du32, met)), du32, children);
    if constexpr (!any) hn::StoreU(hn::Compress(boxes.enter, met), d, nears);
    return static_cast<std::size_t>(std::popcount(mask_bits(met)));
  } else {
    HWY_ALIGN std::array<float, Node::width> enter;
    unsigned bits = 0;
    for (std::size_t lane = 0; lane < enter.size(); lane += hn::MaxLanes(D())) {
      const Slabs<D> boxes = test_boxes(d, node, lane, slabs, tmin, tmax);
      hn::Store(boxes.enter, d, enter.data() + lane);
      bits |= mask_bits(boxes.met()) << lane;
    }
    std::size_t count = 0;
    for (std::size_t i = 0; i < enter.size(); ++i) {
      const std::size_t slot = any ? i : node.order[order.row][(i ^ order.reversed) & (enter.size() - 1)];
      children[count] = node.child[slot];
      if constexpr (!any) nears[count] = enter[slot];
      count += (bits >> slot) & 1U;
    }
    return count;
  }
}

/// Rays that have nothing to do with each other, traversed in turns. In a loop over one ray each step waits for the one before,
/// and what kind of step comes next cannot be predicted. Here the processor works on the steps of several rays at once, and no
/// branch depends on what comes next: rays stand in a queue for inner nodes or in one for leaves, and the same instructions put
/// them into either.
template <class Node, bool any, class Counter>
class RaysInFlight {
 public:
  /// `most` rays at a time.
  RaysInFlight(const Tree& tree, std::span<const Ray> rays, std::size_t most)
      : tree_(tree),
        nodes_(static_cast<const Node*>(tree.nodes)),
        rays_(rays),
        inner_(most + 1),
        leaves_(most + 1),
        landed_(most + 1),
        flights_(most) {
    const std::size_t room = stack_room(tree, Node::width) + 1;
    children_.resize(room * most);
    nears_.resize(room * most);
    for (std::size_t i = 0; i < most; ++i) {
      // The entry before the first is what comes when nothing waits.
      flights_[i].children = children_.data() + room * i + 1;
      flights_[i].nears = nears_.data() + room * i + 1;
      flights_[i].children[-1] = landed;
    }
  }

  /// write(i, hit, counter) once for every ray i, in no order.
  template <class Write>
  void run(Write&& write) {
    for (std::uint32_t slot = 0; slot < flights_.size(); ++slot) start(slot, write);
    while (inner_count_ + leaf_count_ > 0) {
      visit_inner_nodes();
      visit_leaves();
      for (std::size_t i = 0; i < landed_count_; ++i) {
        const Flight& flight = flights_[landed_[i]];
        write(flight.index, flight.hit.is_hit() ? flight.hit : Hit{}, flight.counter);
        start(landed_[i], write);
      }
      landed_count_ = 0;
    }
  }

 private:
  using D = FloatsOf<Node::width>;
  /// In the place of a child: the ray has none left. A leaf that no tree has, so that no further test is needed to tell it from
  /// inner nodes.
  static constexpr std::uint32_t landed = 0xffffffffU;

  struct Flight {
    std::optional<WideRay> ray;
    float tmin = 0;      ///< of the ray's t
    float entry = 0;     ///< tmin of the boxes' t
    float farthest = 0;  ///< tmax of the boxes' t, or where the nearest hit so far is
    std::uint32_t child = 0;
    std::ptrdiff_t waiting = 0;  ///< on the stack
    std::uint32_t* children = nullptr;
    float* nears = nullptr;
    Hit hit;
    std::size_t index = 0;
    Counter counter;
  };

  template <class Write>
  void start(std::uint32_t slot, Write&& write) {
    Flight& flight = flights_[slot];
    for (; next_ < rays_.size(); ++next_) {
      const Ray& ray = rays_[next_];
      flight.ray.emplace(ray, tree_.slabs);
      flight.counter = {};
      if (!flight.ray->valid) {
        write(next_, Hit{}, flight.counter);
        continue;
      }
      flight.tmin = ray.tmin;
      flight.entry = flight.ray->scaled(ray.tmin);
      flight.farthest = flight.ray->scaled(ray.tmax);
      flight.child = 0;
      flight.waiting = 0;
      flight.hit = Hit{};
      flight.hit.t = ray.tmax;
      flight.index = next_++;
      inner_[inner_count_++] = slot;
      return;
    }
  }

  /// All queues take the slot; only one keeps it.
  HWY_INLINE void queue(std::uint32_t slot, std::uint32_t child) {
    const std::size_t is_leaf = child >> 31U;
    const std::size_t is_landed = child == landed ? 1 : 0;
    inner_[inner_count_] = slot;
    leaves_[leaf_count_] = slot;
    landed_[landed_count_] = slot;
    inner_count_ += 1 - is_leaf;
    leaf_count_ += is_leaf - is_landed;
    landed_count_ += is_landed;
    // In the place of one that has landed the root, which is at hand.
    tree_.prefetch(child & (static_cast<std::uint32_t>(is_landed) - 1));
  }

  void visit_inner_nodes() {
    const D d;
    const std::size_t count = std::exchange(inner_count_, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t slot = inner_[i];
      Flight& flight = flights_[slot];
      flight.counter.inner();
      flight.counter.boxes(Node::width);
      const std::size_t met = push_met<any>(
          d, nodes_[flight.child], SlabVectors<D>(d, *flight.ray), RayOrder<D>(flight.ray->negative), hn::Set(d, flight.entry),
          hn::Set(d, flight.farthest), flight.children + flight.waiting, flight.nears + flight.waiting);
      flight.waiting += static_cast<std::ptrdiff_t>(met) - 1;
      flight.child = flight.children[flight.waiting];
      queue(slot, flight.child);
    }
  }

  void visit_leaves() {
    const FloatsOf<8> d;
    const std::size_t count = std::exchange(leaf_count_, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t slot = leaves_[i];
      Flight& flight = flights_[slot];
      flight.counter.leaf();
      flight.counter.triangles(WideChild::count(flight.child));
      if (test_leaf<any>(d, tree_, flight.child, *flight.ray, ShearVectors<FloatsOf<8>>(d, *flight.ray), flight.tmin,
                         flight.hit)) {
        if (any) {
          flight.waiting = 0;
        } else {
          flight.farthest = flight.ray->scaled(flight.hit.t);
          drop_farther(flight);
        }
      }
      flight.child = flight.children[--flight.waiting];
      queue(slot, flight.child);
    }
  }

  /// Takes from the stack what begins behind the hit.
  void drop_farther(Flight& flight) {
    const D d;
    const hn::Rebind<std::uint32_t, D> du32;
    const auto count = static_cast<std::size_t>(flight.waiting);
    const auto farthest = hn::Set(d, flight.farthest);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; i += hn::MaxLanes(d)) {
      const auto nears = hn::LoadU(d, flight.nears + i);
      const auto children = hn::LoadU(du32, flight.children + i);
      const auto keep = hn::And(hn::Le(nears, farthest), hn::FirstN(d, count - i));
      hn::StoreU(hn::Compress(nears, keep), d, flight.nears + kept);
      hn::StoreU(hn::Compress(children, hn::RebindMask(du32, keep)), du32, flight.children + kept);
      kept += static_cast<std::size_t>(std::popcount(mask_bits(keep)));
    }
    flight.waiting = static_cast<std::ptrdiff_t>(kept);
  }

  const Tree& tree_;
  const Node* nodes_;
  std::span<const Ray> rays_;
  std::size_t next_ = 0;
  std::size_t inner_count_ = 0;
  std::size_t leaf_count_ = 0;
  std::size_t landed_count_ = 0;
  std::vector<std::uint32_t> inner_;
  std::vector<std::uint32_t> leaves_;
  std::vector<std::uint32_t> landed_;
  std::vector<Flight> flights_;
  std::vector<std::uint32_t> children_;
  std::vector<float> nears_;
};

}  // namespace raystudy::wide::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
