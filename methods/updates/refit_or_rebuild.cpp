#include <cstdint>
#include <optional>
#include <utility>

#include "harness/method/registry.h"
#include "methods/updates/degradation.h"
#include "methods/updates/refit_session.h"

namespace raystudy::updates {
namespace {

struct Policy {
  RefitMethod method = RefitMethod::serial;
  double threshold = 0;
  std::size_t every = 0;
};

/// A tree that knows how good it was when it was built.
struct WatchedTree {
  RefittedTree tree;
  Degradation since_build;

  WatchedTree(std::unique_ptr<Bvh2> bvh, const Scene& scene, const Policy& policy, int threads)
      : tree(with_whole_boxes(RefittedTree(std::move(bvh), scene, policy.method, threads), scene)),
        since_build(*tree.bvh, threads) {}
  [[nodiscard]] std::size_t bytes() const { return tree.bytes() + since_build.bytes(); }

 private:
  /// Boxes of spatial splits grow when they are first refitted, which is no movement.
  static RefittedTree with_whole_boxes(RefittedTree tree, const Scene& scene) {
    if (tree.bvh->duplicates) tree.refit(scene);
    return tree;
  }
};

class RefitOrRebuildSession final : public UpdateSession {
 public:
  RefitOrRebuildSession(WatchedTree first, TreeBuild build, const Policy& policy, int threads)
      : first_(std::move(first)), build_(std::move(build)), policy_(policy), threads_(threads) {}

  FrameUpdate update(const Scene& frame, std::size_t index) override {
    if (index == 0) rebuilt_.reset();
    if (policy_.every > 0 && index > 0 && index % policy_.every == 0) return rebuild(frame);
    WatchedTree& now = rebuilt_ ? *rebuilt_ : first_;
    now.tree.refit(frame);
    if (policy_.every == 0 && now.since_build.of(*now.tree.bvh) > policy_.threshold) return rebuild(frame);
    return {now.tree.bvh.get(), false};
  }
  [[nodiscard]] std::size_t bytes() const override { return first_.bytes() + (rebuilt_ ? rebuilt_->bytes() : 0); }

 private:
  FrameUpdate rebuild(const Scene& frame) {
    rebuilt_.reset();
    rebuilt_.emplace(take_bvh2(build_(frame), "refit-or-rebuild"), frame, policy_, threads_);
    return {rebuilt_->tree.bvh.get(), true};
  }

  WatchedTree first_;  ///< kept, as the animation begins anew with it
  std::optional<WatchedTree> rebuilt_;
  TreeBuild build_;
  Policy policy_;
  int threads_;
};

class RefitOrRebuild final : public Updater {
 public:
  static MethodInfo info() {
    return {.name = "refit-or-rebuild",
            .summary = "refits each frame, and builds the tree anew where its boxes have grown too much, or every t frames",
            .citation = "Lauterbach 2010, Sec. 4.1.4 and 4.1.5",
            .params = {refit_method_param(),
                       real_param("threshold", 0.4,
                                  "rebuilds where the mean ratio of a node's area to its children's has grown by more since the "
                                  "tree was built",
                                  0, 1e9),
                       integer_param("every", 0, "rebuilds every so many frames instead; 0: by the threshold", 0, 1e9)},
            .accel = "bvh2"};
  }
  explicit RefitOrRebuild(const Params& p)
      : policy_{refit_method(p.text("method")), p.real("threshold"), static_cast<std::size_t>(p.integer("every"))} {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> /*times*/,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    WatchedTree first(take_bvh2(build(animation), "refit-or-rebuild"), animation, policy_, context.threads);
    return std::make_unique<RefitOrRebuildSession>(std::move(first), build, policy_, context.threads);
  }

 private:
  Policy policy_;
};

const Registration<RefitOrRebuild> registration;

}  // namespace
}  // namespace raystudy::updates
