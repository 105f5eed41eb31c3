#include <utility>

#include "harness/method/registry.h"
#include "methods/spatial/spatial_build.h"

namespace raystudy {
namespace {

std::vector<ParamSpec> sbvh_params() {
  std::vector<ParamSpec> specs{
      integer_param("bins", 32, "bins of box centers an axis, at most, for object splits", 2, 1024),
      integer_param("spatial_bins", 16, "bins of space an axis, at most, for spatial splits", 2, 1024),
      real_param("alpha", 1e-5,
                 "spatial splits are tried where the sides of the best object split overlap by more than this share of the "
                 "root's measure",
                 0, 1),
      real_param("budget", 0.2, "references more than triangles, at most, as a share of the triangles", 0, 16),
      boolean_param("unsplitting", true, "a reference goes to one side as a whole where that costs less than to split it"),
      method_param("heuristic", Role::heuristic, "surface-area", "the measure whose cost the splits minimize")};
  for (ParamSpec& spec : topdown::LeafPolicy::params()) specs.push_back(std::move(spec));
  return specs;
}

/// Top-down construction by object splits between bins of box centers and spatial splits between bins of space.
class Sbvh final : public Builder {
 public:
  explicit Sbvh(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "sbvh",
            .summary = "top-down by object splits and spatial splits, with references to a triangle from several leaves",
            .citation = "Stich, Friedrich and Dietrich 2009",
            .params = sbvh_params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto measure = Registry::instance().create<Heuristic>(params_.method("heuristic"))->prepare(scene, context);
    const spatial::SpatialPolicy policy{.bins = static_cast<std::uint32_t>(params_.integer("bins")),
                                        .spatial_bins = static_cast<std::uint32_t>(params_.integer("spatial_bins")),
                                        .alpha = static_cast<float>(params_.real("alpha")),
                                        .budget = params_.real("budget"),
                                        .unsplitting = params_.boolean("unsplitting")};
    return spatial::build_with_spatial_splits(scene, context, policy, topdown::LeafPolicy(params_, context.cost), *measure);
  }

 private:
  Params params_;
};

const Registration<Sbvh> registration;

}  // namespace
}  // namespace raystudy
