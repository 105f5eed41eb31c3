#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "harness/accel/refit.h"
#include "harness/method/method.h"

namespace raystudy::updates {

/// What a pipeline built, which `updater` needs as a binary tree. Throws Error for anything else.
[[nodiscard]] std::unique_ptr<Bvh2> take_bvh2(std::unique_ptr<Accel> tree, std::string_view updater);

/// A tree together with what refits it.
struct RefittedTree {
  std::unique_ptr<Bvh2> bvh;
  Refitter refitter;

  RefittedTree(std::unique_ptr<Bvh2> tree, const Scene& scene, RefitMethod method, int threads)
      : bvh(std::move(tree)), refitter(*bvh, scene.triangles, method, threads) {}
  void refit(const Scene& frame) { refitter.refit(*bvh, frame.vertices); }
  [[nodiscard]] std::size_t bytes() const { return bvh->bytes() + refitter.bytes(); }
};

/// SAH*: of the trees that each frame alone would get, the one of least mean cost over all frames when refitted; of equal ones
/// the earliest (Wald, Boulos, Shirley 2007). `times` are not empty.
[[nodiscard]] RefittedTree best_tree_over_time(const Scene& animation, std::span<const double> times, const TreeBuild& build,
                                               RefitMethod method, const BuildContext& context, std::string_view updater);

/// One tree that follows the whole animation.
class RefitSession final : public UpdateSession {
 public:
  explicit RefitSession(RefittedTree tree) : tree_(std::move(tree)) {}
  FrameUpdate update(const Scene& frame, std::size_t /*index*/) override {
    tree_.refit(frame);
    return {tree_.bvh.get(), false};
  }
  [[nodiscard]] std::size_t bytes() const override { return tree_.bytes(); }

 private:
  RefittedTree tree_;
};

/// The parameter `method` of every updater that refits.
[[nodiscard]] inline ParamSpec refit_method_param() {
  return choice_param("method", refit_method_names(), "how boxes are recomputed; the same boxes, at another speed");
}

}  // namespace raystudy::updates
