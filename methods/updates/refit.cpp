#include <fmt/format.h>

#include "harness/base/error.h"
#include "harness/method/registry.h"
#include "methods/updates/refit_session.h"

namespace raystudy::updates {

std::unique_ptr<Bvh2> take_bvh2(std::unique_ptr<Accel> tree, std::string_view updater) {
  if (auto* bvh = dynamic_cast<Bvh2*>(tree.get())) {
    (void)tree.release();
    return std::unique_ptr<Bvh2>(bvh);
  }
  throw Error(Diagnostic{{},
                         fmt::format("updater '{}' got a tree of kind '{}'", updater, tree ? tree->kind() : "none"),
                         fmt::format("a builder of '{}'", Bvh2::kind_name),
                         {}});
}

namespace {

class Refit final : public Updater {
 public:
  static MethodInfo info() {
    return {.name = "refit",
            .summary = "one tree, built on the first frame; the boxes of every other are recomputed",
            .citation = "Lauterbach 2010, Sec. 4.1.3 and 4.2.2; with sweep-sah SAH^0 of Bittner and Meister 2015",
            .params = {refit_method_param()},
            .accel = "bvh2"};
  }
  explicit Refit(const Params& p) : method_(refit_method(p.text("method"))) {}

  [[nodiscard]] std::unique_ptr<UpdateSession> prepare(const Scene& animation, std::span<const double> /*times*/,
                                                       const TreeBuild& build, const BuildContext& context) const override {
    return std::make_unique<RefitSession>(
        RefittedTree(take_bvh2(build(animation), "refit"), animation, method_, context.threads));
  }

 private:
  RefitMethod method_;
};

const Registration<Refit> registration;

}  // namespace
}  // namespace raystudy::updates
