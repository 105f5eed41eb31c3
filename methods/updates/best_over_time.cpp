#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/animation.h"
#include "methods/updates/refit_session.h"

namespace raystudy::updates {

/// Two trees at most are held at once: the best so far and the one that is tried.
RefittedTree best_tree_over_time(const Scene& animation, std::span<const double> times, const TreeBuild& build,
                                 RefitMethod method, const BuildContext& context, std::string_view updater) {
  std::vector<Scene> frames;
  for (const double time : times) frames.push_back(scene_at(animation, time));
  std::optional<RefittedTree> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Scene& own : frames) {
    RefittedTree tree(take_bvh2(build(own), updater), animation, method, context.threads);
    double sum = 0;
    for (const Scene& frame : frames) {
      tree.refit(frame);
      sum += tree_cost(*tree.bvh, context.cost);
    }
    if (best && !(sum < least)) continue;
    least = sum;
    best.emplace(std::move(tree));
  }
  return std::move(*best);
}

namespace {

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

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> times,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    return std::make_unique<RefitSession>(best_tree_over_time(animation, times, build, method_, context, "best-over-time"));
  }

 private:
  RefitMethod method_;
};

const Registration<BestOverTime> registration;

}  // namespace
}  // namespace raystudy::updates
