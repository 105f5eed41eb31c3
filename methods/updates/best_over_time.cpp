#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/refit_session.h"

namespace raystudy::updates {
namespace {

/// SAH*: of the trees that each frame alone would get, the one of least mean cost over all frames when refitted. Of equal ones
/// the earliest.
class BestOverTime final : public Updater {
 public:
  static MethodInfo info() {
    return {.name = "best-over-time",
            .summary = "of the trees built for single frames the one that is cheapest over all frames, refitted",
            .citation = "Wald, Boulos, Shirley 2007; SAH* of Bittner and Meister 2015, Sec. 6",
            .params = {refit_method_param()},
            .accel = "bvh2"};
  }
  explicit BestOverTime(const Params& p) : method_(refit_method(p.text("method"))) {}

  /// Two trees at most are held at once: the best so far and the one that is tried.
  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    std::vector<Scene> frames;
    for (const double time : times) frames.push_back(scene_at(animation, time));
    std::optional<RefittedTree> best;
    double least = std::numeric_limits<double>::infinity();
    for (const Scene& own : frames) {
      RefittedTree tree(take_bvh2(build(own), "best-over-time"), animation, method_, context.threads);
      double sum = 0;
      for (const Scene& frame : frames) {
        tree.refit(frame);
        sum += tree_cost(*tree.bvh, context.cost);
      }
      if (best && !(sum < least)) continue;
      least = sum;
      best.emplace(std::move(tree));
    }
    return std::make_unique<RefitSession>(std::move(*best));
  }

 private:
  RefitMethod method_;
};

const Registration<BestOverTime> registration;

}  // namespace
}  // namespace raystudy::updates
