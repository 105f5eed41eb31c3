#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/method/registry.h"
#include "methods/rotations/rotations.h"
#include "methods/updates/refit_session.h"

namespace raystudy::updates {
namespace {

/// One pass over a tree whose records lie depth first, as PairTree makes them: the boxes of both children, then the best
/// rotation, then the node's own box. What happens at a node depends on what is below it alone.
template <class M>
class RotatingPass {
 public:
  RotatingPass(PairTree& tree, const Bvh2& bvh, const Scene& frame, const M& measure)
      : tree_(tree), bvh_(bvh), frame_(frame), measure_(measure) {}

  void run(int threads) {
    const auto size = static_cast<std::uint32_t>(tree_.pairs.size());
    constexpr std::uint32_t least = 1024;  // fewer are not worth a task
    list_tasks(threads == 1 ? size : std::max(least, size / (8 * static_cast<std::uint32_t>(threads))));
    const auto run_tasks = [this](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) rotate(subtrees_[i]);
    };
    if (threads == 1) {
      run_tasks(0, subtrees_.size());
    } else {
      with_threads(threads, [&] { parallel_for_blocks(subtrees_.size(), 1, run_tasks); });
    }
    rotations::Rotator<M> rotator(tree_, measure_, unmeasured);
    for (const Range& subtree : subtrees_) rotator.refit(subtree.begin);
    for (std::size_t i = above_.size(); i-- > 0;) {
      rotate(rotator, above_[i]);
      rotator.refit(above_[i]);
    }
  }

 private:
  struct Range {
    std::uint32_t begin;
    std::uint32_t end;
  };
  static constexpr typename rotations::Rotator<M>::Unmeasured unmeasured{};

  /// Cuts the records into subtrees of at most `most` and those above them.
  void list_tasks(std::uint32_t most) {
    std::vector<Range> pending{{tree_.root(), static_cast<std::uint32_t>(tree_.pairs.size())}};
    while (!pending.empty()) {
      const Range range = pending.back();
      pending.pop_back();
      if (range.end - range.begin <= most) {
        subtrees_.push_back(range);
        continue;
      }
      above_.push_back(range.begin);
      const auto& [left, right] = tree_.pairs[range.begin].link;
      const std::uint32_t middle = PairTree::is_leaf(right) ? range.end : right;
      if (!PairTree::is_leaf(right)) pending.push_back({right, range.end});
      if (!PairTree::is_leaf(left)) pending.push_back({left, middle});
    }
  }

  /// The box of the subtree's root is left to the caller: it stands in a record that another task may write to.
  void rotate(Range subtree) {
    rotations::Rotator<M> rotator(tree_, measure_, unmeasured);
    for (std::uint32_t n = subtree.end; n-- > subtree.begin;) {
      rotate(rotator, n);
      if (n != subtree.begin) rotator.refit(n);
    }
  }

  void rotate(rotations::Rotator<M>& rotator, std::uint32_t n) {
    PairTree::Pair& pair = tree_.pairs[n];
    for (std::uint32_t side = 0; side < 2; ++side) {
      if (!PairTree::is_leaf(pair.link[side])) continue;
      const PairTree::Leaf leaf = tree_.leaves[pair.link[side] & ~PairTree::leaf_bit];
      Box box;
      for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) box.extend(frame_.triangle_box(bvh_.triangles[i]));
      const BoxPair twice = BoxPair::twice(box);
      pair.boxes.set(side, twice);
      pair.measure[side] = measure_both(measure_, twice)[0];
    }
    rotator.climb(n);
  }

  PairTree& tree_;
  const Bvh2& bvh_;
  const Scene& frame_;
  const M& measure_;
  std::vector<Range> subtrees_;
  std::vector<std::uint32_t> above_;  ///< parents first
};

class RefitRotationsSession final : public UpdateSession {
 public:
  RefitRotationsSession(std::unique_ptr<Bvh2> first, const BuildContext& context)
      : first_(std::move(first)), bvh_(*first_), cost_(context.cost), threads_(context.threads) {}

  FrameUpdate update(const Scene& frame, std::size_t index) override {
    if (index == 0) bvh_ = *first_;
    if (bvh_.leaf_count() < 2) {
      Refitter(bvh_, frame.triangles, RefitMethod::serial, 1).refit(bvh_, frame.vertices);
      return {&bvh_, false};
    }
    PairTree tree(bvh_);
    visit_measure(*cost_.measure, [&](const auto& measure) { RotatingPass(tree, bvh_, frame, measure).run(threads_); });
    tree.write_to(bvh_);
    return {&bvh_, false};
  }
  [[nodiscard]] std::size_t bytes() const override { return first_->bytes() + bvh_.bytes(); }

 private:
  std::unique_ptr<Bvh2> first_;  ///< kept, as the animation begins anew with it
  Bvh2 bvh_;
  CostModel cost_;
  int threads_;
};

class RefitRotations final : public Updater {
 public:
  static MethodInfo info() {
    return {.name = "refit-rotations",
            .summary = "recomputes boxes and rotates nodes to their least cost in one pass, from the tree of the frame before",
            .citation = "Kopta et al.: Fast, Effective BVH Updates for Animated Scenes, I3D 2012; the rotations of Kensler 2008",
            .params = {},
            .accel = "bvh2"};
  }
  explicit RefitRotations(const Params& /*params*/) {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> /*times*/,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    return std::make_unique<RefitRotationsSession>(take_bvh2(build(animation), "refit-rotations"), context);
  }
};

const Registration<RefitRotations> registration;

}  // namespace
}  // namespace raystudy::updates
