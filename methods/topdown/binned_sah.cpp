#include <utility>

#include "harness/method/registry.h"
#include "methods/topdown/binned_split.h"

namespace raystudy {
namespace {

/// Top-down construction that evaluates the splits between bins of box centers.
class BinnedSah final : public Builder {
 public:
  explicit BinnedSah(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {.name = "binned-sah",
            .summary = "top-down, the best split between equal bins of box centers on three axes",
            .citation = "Wald 2007, Sec. 3",
            .params = topdown::binned_params(),
            .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    const auto measure = Registry::instance().create<Heuristic>(params_.method("heuristic"))->prepare(scene, context);
    const topdown::LeafPolicy leaves(params_, context.cost);
    const auto bins = static_cast<std::uint32_t>(params_.integer("bins"));
    return topdown::build_from_records(scene, context, leaves, *measure,
                                       topdown::BinnedSplitter(*measure, bins, context.threads));
  }

 private:
  Params params_;
};

const Registration<BinnedSah> registration;

}  // namespace
}  // namespace raystudy
