#include <utility>

#include "harness/base/parallel.h"
#include "harness/method/registry.h"
#include "methods/topdown/compact.h"
#include "methods/topdown/sweep_build.h"

namespace raystudy {
namespace {

using topdown::LeafPolicy;
using topdown::Positions;

std::vector<ParamSpec> sweep_params() {
  std::vector<ParamSpec> specs{
      choice_param("positions", {"box-centers", "centroids", "box-bounds"},
                   "what orders triangles along an axis; box-bounds: two orders an axis, by lower and by upper bound"),
      method_param("heuristic", Role::heuristic, "surface-area", "the measure whose cost the splits minimize")};
  for (ParamSpec& spec : LeafPolicy::params()) specs.push_back(std::move(spec));
  return specs;
}

/// Top-down construction that evaluates every split of the triangles in every order.
class SweepSah final : public Builder {
 public:
  explicit SweepSah(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "sweep-sah",
            .summary = "top-down, the best split of all positions on three axes, O(N log N)",
            .citation =
                "MacDonald and Booth 1990; Wald and Havran 2006, Sec. 4.3 (sorted once); Bittner, Hapala and Havran 2015, Sec. 3",
            .params = sweep_params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    const auto heuristic = Registry::instance().create<Heuristic>(params_.method("heuristic"));
    const std::shared_ptr<const Measure> measure = heuristic->prepare(scene, context);
    const LeafPolicy leaves(params_, context.cost);
    with_threads(context.threads, [&] {
      topdown::SweepOrders orders(scene, positions(), context.threads, [&] {
        bvh->nodes.resize(2 * scene.triangles.size());
        bvh->triangles.resize(scene.triangles.size());
      });
      visit_measure(*measure, [&](const auto& m) {
        topdown::SweepBuild<std::decay_t<decltype(m)>>(m, leaves, orders, *bvh, context.threads).run();
      });
    });
    if (leaves.sah) bvh->nodes.resize(topdown::close_gaps(bvh->nodes, 0, 2));
    return bvh;
  }

 private:
  [[nodiscard]] Positions positions() const {
    const std::string& name = params_.text("positions");
    if (name == "centroids") return Positions::centroids;
    return name == "box-bounds" ? Positions::box_bounds : Positions::box_centers;
  }

  Params params_;
};

const Registration<SweepSah> registration;

}  // namespace
}  // namespace raystudy
