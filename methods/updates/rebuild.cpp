#include <numeric>
#include <utility>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/animation.h"

namespace raystudy::updates {
namespace {

/// All trees are there before the animation is played.
class BuiltBefore final : public UpdateSession {
 public:
  explicit BuiltBefore(std::vector<std::unique_ptr<Accel>> trees) : trees_(std::move(trees)) {}
  FrameUpdate update(const Scene& /*frame*/, std::size_t index) override { return {trees_.at(index).get(), false}; }
  [[nodiscard]] std::size_t bytes() const override {
    return std::accumulate(trees_.begin(), trees_.end(), std::size_t{0},
                           [](std::size_t sum, const auto& tree) { return sum + tree->bytes(); });
  }

 private:
  std::vector<std::unique_ptr<Accel>> trees_;
};

class BuiltEachFrame final : public UpdateSession {
 public:
  explicit BuiltEachFrame(TreeBuild build) : build_(std::move(build)) {}
  FrameUpdate update(const Scene& frame, std::size_t /*index*/) override {
    tree_ = build_(frame);
    return {tree_.get(), true};
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_ ? tree_->bytes() : 0; }

 private:
  TreeBuild build_;
  std::unique_ptr<Accel> tree_;
};

class Rebuild final : public Updater {
 public:
  static MethodInfo info() {
    return {.name = "rebuild",
            .summary = "a tree of its own for every frame",
            .citation = "Bittner and Meister 2015, Sec. 6 (SAH-rebuild: built before; HLBVH: each frame)",
            .params = {choice_param("when", {"before", "each-frame"},
                                    "all trees before the animation is played, or each as part of its frame's update")}};
  }
  explicit Rebuild(const Params& p) : before_(p.text("when") == "before") {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                       const TreeBuild& build, const BuildContext& /*context*/) const override {
    if (!before_) return std::make_unique<BuiltEachFrame>(build);
    std::vector<std::unique_ptr<Accel>> trees;
    for (const double time : times) trees.push_back(build(scene_at(animation, time)));
    return std::make_unique<BuiltBefore>(std::move(trees));
  }

 private:
  bool before_;
};

const Registration<Rebuild> registration;

}  // namespace
}  // namespace raystudy::updates
