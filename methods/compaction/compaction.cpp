#include "harness/method/compaction.h"

#include <chrono>
#include <cstdint>

#include "harness/method/frame_weights.h"
#include "harness/method/registry.h"
#include "harness/scene/animation.h"

namespace raystudy {
namespace {

class Compaction final : public Optimizer {
 public:
  static MethodInfo info() {
    return {.name = "compaction",
            .summary = "collapses every subtree that costs more than one leaf over its triangles",
            .citation =
                "Bittner: Optimized Data Structures for Ray Tracing, 2015, Section 2.6; over frames: Bittner and Meister 2015, "
                "Section 5.4",
            .params = {integer_param("max_leaf_triangles", 0, "makes no larger leaves; 0: no limit", 0, 4294967295.0),
                       integer_param("frames", 0, "costs over so many representative frames; 0: of the tree as it is", 0, 64),
                       real_param("exponent", 0, "of several frames: the weight of a frame is this power of its cost", 0, 1000)},
            .accel = "bvh2"};
  }

  explicit Compaction(const Params& p)
      : max_leaf_triangles_(static_cast<std::uint32_t>(p.integer("max_leaf_triangles"))),
        frames_(static_cast<std::size_t>(p.integer("frames"))),
        exponent_(p.real("exponent")) {}

  void optimize(Bvh2& bvh, const Scene& scene, const BuildContext& context) const override {
    const auto start = Clock::now();
    const auto record = [&](double seconds) {
      if (context.cost_trace != nullptr) context.cost_trace->push_back({seconds, tree_cost(bvh, context.cost)});
    };
    record(0);
    if (frames_ == 0 || bvh.empty()) {
      compact(bvh, context.cost, max_leaf_triangles_);
    } else {
      const std::vector<SharedArray<Vec3>> frames = resampled_frames(scene, frames_);
      compact(bvh, weighted_measures(bvh, scene, frames, exponent_, context.cost), context.cost, max_leaf_triangles_);
    }
    record(std::chrono::duration<double>(Clock::now() - start).count());
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::uint32_t max_leaf_triangles_;
  std::size_t frames_;
  double exponent_;
};

const Registration<Compaction> registration;

}  // namespace
}  // namespace raystudy
