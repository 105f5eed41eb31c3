#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

#include "harness/base/error.h"
#include "harness/base/parallel.h"
#include "harness/method/registry.h"
#include "methods/lbvh/linear.h"

namespace raystudy::lbvh {
namespace {

class Hlbvh final : public Builder {
 public:
  explicit Hlbvh(Params params)
      : params_(std::move(params)),
        shape_{.morton_bits = std::stoi(params_.text("morton_bits")),
               .max_leaf_triangles = static_cast<std::uint32_t>(params_.integer("max_leaf_triangles"))} {
    if (params_.text("split") != "sah") return;
    shape_.treelet_bits = static_cast<int>(params_.integer("sah_bits"));
    if (shape_.treelet_bits > shape_.morton_bits) {
      throw Error(fmt::format("hlbvh: sah_bits is {}, but codes have {} bits (morton_bits); expected no more",
                              shape_.treelet_bits, shape_.morton_bits));
    }
  }

  static MethodInfo info() {
    return {
        .name = "hlbvh",
        .summary = "a tree along the Morton curve with leaves of several triangles, under a tree by SAH over its treelets",
        .citation =
            "Pantaleoni, Luebke: HLBVH: Hierarchical LBVH Construction for Real-Time Ray Tracing, 2010; Garanzha, "
            "Pantaleoni, McAllister: Simpler and Faster HLBVH with Work Queues, 2011",
        .params = {choice_param("split", {"sah", "median"}, "sah: of treelets by binned SAH; median: all by Morton codes"),
                   choice_param("morton_bits", {"30", "63"}, "bits of the Morton codes that order the triangles"),
                   integer_param("sah_bits", 15, "with split: sah, the leading bits of its code that a treelet shares", 1, 63),
                   integer_param("bins", 16, "with split: sah, bins an axis", 2, 1024),
                   integer_param("max_leaf_triangles", 8, "a range of so many triangles is a leaf", 1, 1 << 20),
                   method_param("heuristic", Role::heuristic, "surface-area", "with split: sah, the measure of boxes")},
        .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    const auto measure = Registry::instance().create<Heuristic>(params_.method("heuristic"))->prepare(scene, context);
    with_threads(context.threads, [&] {
      if (shape_.treelet_bits == 0) {
        build_linear(scene, shape_, Construction::apetrei, context.threads, *bvh);
      } else {
        build_treelets(scene, shape_, *measure, static_cast<std::uint32_t>(params_.integer("bins")), context.threads, *bvh);
      }
    });
    return bvh;
  }

 private:
  Params params_;
  Shape shape_;
};

const Registration<Hlbvh> registration;

}  // namespace
}  // namespace raystudy::lbvh
