#include "methods/spatial/spatial_build.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "methods/spatial/division.h"
#include "methods/topdown/binned_split.h"

namespace raystudy::spatial {
namespace {

using topdown::BinnedSplitter;
using topdown::BoxRecords;
using topdown::FewBoxes;
using topdown::FewSet;
using topdown::NodeBounds;

/// A part of the tree under construction: its node, and room for `capacity` references and their nodes, as topdown::Subtree has
/// it for `count`. What `count` leaves of it are the references that spatial splits may add below. Children share what is left by
/// what they are expected to cost, so that where a node ends up depends on no thread.
struct Subtree {
  std::uint32_t node = 0;
  std::uint32_t pairs = 2;
  std::uint32_t begin = 0;
  std::uint32_t count = 0;
  std::uint32_t capacity = 0;

  [[nodiscard]] std::uint32_t extra() const { return capacity - count; }
  /// `m`: the measures of the sides. A child of one reference is a leaf, which has no use for more.
  [[nodiscard]] std::array<Subtree, 2> children(std::uint32_t left, std::uint32_t right, const std::array<float, 2>& m) const {
    const double unused = capacity - left - right;
    const double l = (left - 1) * static_cast<double>(m[0]);
    const double r = (right - 1) * static_cast<double>(m[1]);
    const double share = l + r > 0 && l + r < 1e300 ? l / (l + r) : 0.5;
    const auto room = left + static_cast<std::uint32_t>(unused * share);
    return {Subtree{pairs, pairs + 2, begin, left, room},
            Subtree{pairs + 1, pairs + 2 * room, begin + room, right, capacity - room}};
  }
};

/// References and nodes in rooms as large as the budget allows; see topdown::RecordBuild, whose scheme this is.
class SpatialBuild {
 public:
  SpatialBuild(const Scene& scene, const SpatialPolicy& policy, const topdown::LeafPolicy& leaves, const Measure& measure,
               int threads)
      : scene_(scene),
        policy_(policy),
        leaves_(leaves),
        measure_(measure),
        threads_(threads),
        capacity_(capacity(scene.triangles.size(), policy.budget)),
        records_(capacity_),
        slots_(std::size_t{2} * capacity_),
        triangles_(std::make_unique_for_overwrite<std::uint32_t[]>(capacity_)) {}

  std::unique_ptr<Bvh2> run() {
    const auto n = static_cast<std::uint32_t>(scene_.triangles.size());
    topdown::fill_records(scene_, threads_, {records_.data(), n});
    const Part root{{0, 2, 0, n, capacity_}, false, topdown::bounds_of({records_.data(), n}, threads_)};
    overlap_ = policy_.alpha * measure_(root.bounds.box);
    TaskGroup tasks;
    tasks.run([&] { build_large(root, tasks); });
    tasks.wait();
    return gathered();
  }

 private:
  struct Part {
    Subtree subtree;
    bool in_slots = false;  ///< which room its records are in
    NodeBounds bounds;
  };
  using Children = std::array<Part, 2>;

  /// What a task needs of its own.
  struct Worker {
    explicit Worker(const SpatialBuild& build)
        : objects(build.measure_.measure(), build.policy_.bins, build.threads_),
          planes(build.scene_, build.measure_, build.policy_.spatial_bins, build.threads_),
          division(build.scene_, build.measure_, build.policy_.unsplitting, build.threads_) {}
    BinnedSplitter objects;
    SpatialSplitter planes;
    Division division;
    std::vector<Part> stack;
    std::size_t leaves = 0;
    std::size_t references = 0;
  };

  static constexpr std::uint32_t large = 8192;  ///< smaller subtrees are one task

  [[nodiscard]] static std::uint32_t capacity(std::size_t triangles, double budget) {
    const double most = static_cast<double>(triangles) * (1 + budget);
    return static_cast<std::uint32_t>(std::min(most, 0x1p31 - 1));
  }

  [[nodiscard]] std::span<BoxRecord> room(const Subtree& s, bool in_slots) {
    return {in_slots ? &slots_[s.count == 1 ? s.node : s.pairs] : &records_[s.begin], s.count};
  }
  [[nodiscard]] Bvh2Node& node(const Subtree& s) {
    // A slot holds a record or a node, and is only ever read as what was written to it last.
    static_assert(sizeof(BoxRecord) == sizeof(Bvh2Node));
    return *reinterpret_cast<Bvh2Node*>(&slots_[s.node]);
  }

  void build_large(Part part, TaskGroup& tasks) {
    Worker worker(*this);
    while (part.subtree.count > large) {
      auto children = make_node(part, worker);
      if (!children) break;
      if ((*children)[1].subtree.count > (*children)[0].subtree.count) std::swap((*children)[0], (*children)[1]);
      tasks.run([other = (*children)[1], this, &tasks] { build_large(other, tasks); });
      part = (*children)[0];
    }
    if (part.subtree.count <= large) worker.stack.push_back(part);
    while (!worker.stack.empty()) {
      const Part top = worker.stack.back();
      worker.stack.pop_back();
      if (top.subtree.count <= FewBoxes::most) {
        build_few(top.subtree, room(top.subtree, top.in_slots).data(), worker);
      } else if (const auto children = make_node(top, worker)) {
        worker.stack.push_back((*children)[1]);
        worker.stack.push_back((*children)[0]);
      }
    }
    leaf_count_ += worker.leaves;
    reference_count_ += worker.references;
  }

  /// Makes the part's node and returns its children, or none where it is a leaf.
  std::optional<Children> make_node(const Part& part, Worker& worker) {
    const auto records = room(part.subtree, part.in_slots);
    const topdown::Split split = worker.objects.split(records, part.bounds);
    std::array<WideBox, 2> sides{part.bounds.box, part.bounds.box};
    std::array<std::uint32_t, 2> counts{part.subtree.count / 2, part.subtree.count - part.subtree.count / 2};
    if (split.left > 0) {
      sides = worker.objects.sides(split.plane);
      counts = {split.left, part.subtree.count - split.left};
    }
    std::optional<Children> children;
    if (tries_planes(part.subtree, sides)) children = divide_space(part, cost(sides, counts), worker);
    if (!children) children = divide_objects(part, split, sides);
    for (Part& child : *children) child.bounds = topdown::bounds_of(room(child.subtree, child.in_slots), threads_);
    if (is_leaf(part, *children)) {
      make_leaf(part.subtree, part.bounds.box.box(), records, worker);
      return {};
    }
    node(part.subtree) = {part.bounds.box.box(), part.subtree.pairs, 0};
    return children;
  }

  [[nodiscard]] float cost(const std::array<WideBox, 2>& boxes, const std::array<std::uint32_t, 2>& counts) const {
    const auto m = measure_(boxes);
    return m[0] * static_cast<float>(counts[0]) + m[1] * static_cast<float>(counts[1]);
  }

  /// Whether the sides of the best object split overlap by so much that spatial splits are worth their time, and whether there
  /// is a reference left to make.
  [[nodiscard]] bool tries_planes(const Subtree& s, const std::array<WideBox, 2>& sides) const {
    if (s.extra() == 0) return false;
    const WideBox both = common(sides[0], sides[1]);
    return !both.is_empty() && measure_(both) > overlap_;
  }

  /// The children by the best plane, where it costs less than `object_cost`.
  std::optional<Children> divide_space(const Part& part, float object_cost, Worker& worker) {
    const Subtree& s = part.subtree;
    const auto records = room(s, part.in_slots);
    const SpatialSplit split = worker.planes.split(records, part.bounds.box, s.extra(), object_cost);
    if (split.axis < 0) return {};
    const auto counts = worker.division.decide(records, split);
    if (counts[0] == 0 || counts[1] == 0 || counts[0] + counts[1] > s.capacity) return {};
    const auto subtrees = s.children(counts[0], counts[1], measure_(split.boxes));
    Children children{Part{subtrees[0], !part.in_slots, {}}, Part{subtrees[1], !part.in_slots, {}}};
    worker.division.divide(room(subtrees[0], !part.in_slots).data(), room(subtrees[1], !part.in_slots).data());
    return children;
  }

  Children divide_objects(const Part& part, const topdown::Split& split, const std::array<WideBox, 2>& sides) {
    const Subtree& s = part.subtree;
    const auto records = room(s, part.in_slots);
    const std::uint32_t left = split.left > 0 ? split.left : s.count / 2;
    const auto subtrees = s.children(left, s.count - left, measure_(sides));
    if (split.left > 0) {
      topdown::divide(records, split.plane, room(subtrees[0], !part.in_slots).data(), room(subtrees[1], !part.in_slots).data(),
                      threads_);
    } else {
      topdown::split_at_median(records, split.plane.axis);
      std::copy(records.begin(), records.begin() + left, room(subtrees[0], !part.in_slots).begin());
      std::copy(records.begin() + left, records.end(), room(subtrees[1], !part.in_slots).begin());
    }
    return {Part{subtrees[0], !part.in_slots, {}}, Part{subtrees[1], !part.in_slots, {}}};
  }

  /// The whole subtree over up to FewBoxes::most references, as far as it is of object splits.
  void build_few(const Subtree& s, const BoxRecord* records, Worker& worker) {
    FewBoxes boxes(records, s.count);
    if (measure_.is_surface_area()) {
      boxes.evaluate(SurfaceArea(), s.count);
    } else {
      boxes.evaluate(measure_.measure(), s.count);
    }
    build_few(s, (1U << s.count) - 1, boxes, worker);
  }

  void build_few(const Subtree& s, FewSet set, const FewBoxes& boxes, Worker& worker) {
    const WideBox box = WideBox::of(boxes.of(set));
    if (s.count > 1) {
      const FewSet left = s.count > 2 ? worker.objects.split_few(boxes, set) : set & (0U - set);
      const FewSet right = set ^ left;
      const float object_cost = boxes.weight(left) + boxes.weight(right);
      if (tries_planes(s, {WideBox::of(boxes.of(left)), WideBox::of(boxes.of(right))}) &&
          divide_few(s, set, boxes, object_cost, worker)) {
        return;
      }
      if (!leaves_.is_leaf(s.count, boxes.measure(set), object_cost)) {
        node(s) = {box.box(), s.pairs, 0};
        const auto left_count = static_cast<std::uint32_t>(std::popcount(left));
        const auto children = s.children(left_count, s.count - left_count, {boxes.measure(left), boxes.measure(right)});
        build_few(children[0], left, boxes, worker);
        build_few(children[1], right, boxes, worker);
        return;
      }
    }
    make_leaf(s, box.box(), to_room(s, set, boxes), worker);
  }

  /// Puts what FewBoxes holds of a set back into the subtree's room.
  std::span<BoxRecord> to_room(const Subtree& s, FewSet set, const FewBoxes& boxes) {
    const auto records = room(s, false);
    auto to = records.begin();
    for (FewSet rest = set; rest != 0; rest &= rest - 1) *to++ = boxes.of(rest & (0U - rest));
    return records;
  }

  /// Whether a plane was better than `object_cost`: the node is made then, and what is below it is on the stack.
  bool divide_few(const Subtree& s, FewSet set, const FewBoxes& boxes, float object_cost, Worker& worker) {
    Part part{s, false, {}};
    part.bounds.box = WideBox::of(boxes.of(set));
    const auto records = to_room(s, set, boxes);
    auto children = divide_space(part, object_cost, worker);
    if (!children) return false;
    for (Part& child : *children) child.bounds = topdown::bounds_of(room(child.subtree, child.in_slots), 1);
    if (is_leaf(part, *children)) {
      make_leaf(s, part.bounds.box.box(), records, worker);
      return true;
    }
    node(s) = {part.bounds.box.box(), s.pairs, 0};
    worker.stack.push_back((*children)[1]);
    worker.stack.push_back((*children)[0]);
    return true;
  }

  /// Whether a leaf costs no more than the split into `children`.
  [[nodiscard]] bool is_leaf(const Part& part, const Children& children) const {
    const std::uint32_t n = part.subtree.count;
    if (!leaves_.sah || n > leaves_.max_triangles) return false;
    const float split =
        cost({children[0].bounds.box, children[1].bounds.box}, {children[0].subtree.count, children[1].subtree.count});
    return leaves_.is_leaf(n, measure_(part.bounds.box), split);
  }

  void make_leaf(const Subtree& s, const Box& box, std::span<const BoxRecord> records, Worker& worker) {
    for (std::uint32_t i = 0; i < s.count; ++i) triangles_[s.begin + i] = records[i].triangle;
    node(s) = {box, s.begin, s.count};
    ++worker.leaves;
    worker.references += s.count;
  }

  /// The tree without the room that was not needed, in the same order: depth first, left before right.
  std::unique_ptr<Bvh2> gathered() {
    auto bvh = std::make_unique<Bvh2>();
    bvh->duplicates = true;
    bvh->nodes.resize(2 * leaf_count_);
    bvh->triangles.resize(reference_count_);
    const auto* slots = reinterpret_cast<const Bvh2Node*>(slots_.data());
    bvh->nodes[0] = slots[0];
    std::uint32_t next = 2;
    std::uint32_t next_triangle = 0;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      Bvh2Node& to = bvh->nodes[stack.back()];
      stack.pop_back();
      if (to.is_leaf()) {
        std::copy_n(&triangles_[to.first], to.count, &bvh->triangles[next_triangle]);
        to.first = std::exchange(next_triangle, next_triangle + to.count);
        continue;
      }
      bvh->nodes[next] = slots[to.first];
      bvh->nodes[next + 1] = slots[to.first + 1];
      to.first = next;
      stack.push_back(next + 1);
      stack.push_back(next);
      next += 2;
    }
    // Parts may be smaller than the reference that was chopped, and a node's box is the union of its children's.
    for (std::uint32_t i = next; i-- > 0;) {
      Bvh2Node& to = bvh->nodes[i];
      if (i != 1 && !to.is_leaf()) to.box = united(bvh->nodes[to.first].box, bvh->nodes[to.first + 1].box);
    }
    return bvh;
  }

  const Scene& scene_;
  const SpatialPolicy& policy_;
  const topdown::LeafPolicy& leaves_;
  BoxMeasure measure_;
  float overlap_ = 0;  ///< the least overlap at which planes are tried, as a measure
  int threads_;
  std::uint32_t capacity_;
  BoxRecords records_;
  BoxRecords slots_;  ///< two a reference, as nodes and as the second room of records
  std::unique_ptr<std::uint32_t[]> triangles_;
  std::atomic<std::size_t> leaf_count_{0};
  std::atomic<std::size_t> reference_count_{0};
};

}  // namespace

std::unique_ptr<Bvh2> build_with_spatial_splits(const Scene& scene, const BuildContext& context, const SpatialPolicy& policy,
                                                const topdown::LeafPolicy& leaves, const Measure& measure) {
  if (scene.triangles.empty()) {
    auto bvh = std::make_unique<Bvh2>();
    bvh->duplicates = true;
    return bvh;
  }
  std::unique_ptr<Bvh2> bvh;
  with_threads(context.threads, [&] { bvh = SpatialBuild(scene, policy, leaves, measure, context.threads).run(); });
  return bvh;
}

}  // namespace raystudy::spatial
