#include <string>
#include <utility>

#include "harness/base/parallel.h"
#include "harness/method/compaction.h"
#include "harness/method/registry.h"
#include "methods/lbvh/linear.h"

namespace raystudy::lbvh {
namespace {

class Lbvh final : public Builder {
 public:
  explicit Lbvh(Params params) : params_(std::move(params)) {}

  static MethodInfo info() {
    return {
        .name = "lbvh",
        .summary = "a node is split where the highest bit of its triangles' Morton codes changes",
        .citation =
            "Lauterbach, Garland, Sengupta, Luebke, Manocha: Fast BVH Construction on GPUs, 2009; Karras: Maximizing "
            "Parallelism in the Construction of BVHs, Octrees, and k-d Trees, 2012; Apetrei: Fast and Simple "
            "Agglomerative LBVH Construction, 2014",
        .params = {choice_param("morton_bits", {"30", "63"}, "bits of the Morton codes that order the triangles"),
                   choice_param("construction", {"apetrei", "karras"},
                                "bottom-up in one pass, or every inner node by itself and boxes then; the same tree"),
                   choice_param("leaves", {"ranges", "sah"},
                                "ranges of max_leaf_triangles and less, or of these subtrees those that cost more than a leaf"),
                   integer_param("max_leaf_triangles", 1, "the most triangles of a leaf", 1, 1 << 20)},
        .accel = std::string(Bvh2::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> build(const Scene& scene, const BuildContext& context) const override {
    auto bvh = std::make_unique<Bvh2>();
    if (scene.triangles.empty()) return bvh;
    const auto most = static_cast<std::uint32_t>(params_.integer("max_leaf_triangles"));
    const bool sah = params_.text("leaves") == "sah";
    const Shape shape{.morton_bits = std::stoi(params_.text("morton_bits")), .max_leaf_triangles = sah ? 1 : most};
    const auto construction = params_.text("construction") == "karras" ? Construction::karras : Construction::apetrei;
    with_threads(context.threads, [&] { build_linear(scene, shape, construction, context.threads, *bvh); });
    if (sah) compact(*bvh, context.cost, most);
    return bvh;
  }

 private:
  Params params_;
};

const Registration<Lbvh> registration;

}  // namespace
}  // namespace raystudy::lbvh
