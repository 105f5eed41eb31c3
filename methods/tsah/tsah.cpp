#include <algorithm>
#include <string>

#include "harness/accel/refit.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/tsah/frame_optimization.h"

namespace raystudy::tsah {
namespace {

using insertion::FrameBoxes;

constexpr std::size_t most_frames = 64;

class Tsah final : public Optimizer {
 public:
  static MethodInfo info() {
    return {
        .name = "tsah",
        .summary = "insertion-based optimization for all frames of an animation at once",
        .citation = "Bittner, Meister: T-SAH: Animation Optimized Bounding Volume Hierarchies, CGF 34(2), 2015",
        .params = {integer_param("frames", 5, "n: representative frames, at equally spaced times", 1, most_frames),
                   real_param("exponent", 0, "k: the weight of a frame is the k-th power of its cost", 0, 1000),
                   real_param("batch_percent", 2, "nodes updated between two updates of the weights, % of all nodes", 0.0001,
                              100),
                   choice_param("selection", {"metropolis-hastings", "batch-sort", "random"}, "how a batch selects its nodes"),
                   integer_param("stop_batches", 3, "stops after this many batches without a new least cost", 1, 1e9),
                   integer_param("random_batches", 3, "batch-sort selects at random after this many such batches", 1, 1e9),
                   choice_param("remove", {"both-children", "one-child"}, "what is taken from a selected node"),
                   choice_param("keep", {"last", "best"}, "which tree is the result: the last batch's, or the cheapest"),
                   integer_param("max_batches", 0, "stops after this many batches; 0: no limit", 0, 1e9),
                   real_param("max_seconds", 0, "stops after this time, in seconds; 0: no limit", 0, 1e9)},
        .accel = "bvh2"};
  }

  explicit Tsah(const Params& p) : frames_(static_cast<std::size_t>(p.integer("frames"))), exponent_(p.real("exponent")) {
    const std::string& selection = p.text("selection");
    options_ = {.batch_percent = p.real("batch_percent"),
                .stop_passes = p.integer("stop_batches"),
                .random_passes = p.integer("random_batches"),
                .selection = selection == "random"       ? insertion::Selection::random
                             : selection == "batch-sort" ? insertion::Selection::area_then_random
                                                         : insertion::Selection::metropolis_hastings,
                .both_children = p.text("remove") == "both-children",
                .keep_best = p.text("keep") == "best",
                .max_passes = p.integer("max_batches"),
                .max_seconds = p.real("max_seconds")};
  }

  void optimize(Bvh2& bvh, const Scene& scene, const BuildContext& context) const override {
    const std::vector<SharedArray<Vec3>> frames = resampled_frames(scene, frames_);
    if (frames.size() == 1 || bvh.leaf_count() < 3) {  // SAH is T-SAH with one frame
      edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& measure, auto start) {
        return insertion::Optimization(tree, measure, options_, context, start).run();
      });
      return;
    }
    over(frames, bvh, scene, context);
    if (!std::equal(scene.vertices.begin(), scene.vertices.end(), frames.front().begin())) {
      Refitter(bvh, scene.triangles, RefitMethod::serial, 1).refit(bvh, scene.vertices);
    }
  }

 private:
  /// By the smallest record that holds all frames.
  void over(std::span<const SharedArray<Vec3>> frames, Bvh2& bvh, const Scene& scene, const BuildContext& context) const {
    const auto run = [&]<class Boxes>(Boxes /*type*/) {
      optimize_over_frames<Boxes>(bvh, scene, frames, exponent_, options_, context);
    };
    const std::size_t n = frames.size();
    if (n <= 2) return run(FrameBoxes<2, 1>());
    if (n <= 3) return run(FrameBoxes<3, 1>());
    if (n <= 4) return run(FrameBoxes<4, 1>());
    if (n <= 5) return run(FrameBoxes<5, 1>());
    if (n <= 8) return run(FrameBoxes<8, 1>());
    if (n <= 10) return run(FrameBoxes<5, 2>());
    if (n <= 16) return run(FrameBoxes<8, 2>());
    if (n <= 32) return run(FrameBoxes<8, 4>());
    return run(FrameBoxes<8, 8>());
  }

  std::size_t frames_;
  double exponent_;
  insertion::Options options_;
};

const Registration<Tsah> registration;

}  // namespace
}  // namespace raystudy::tsah
