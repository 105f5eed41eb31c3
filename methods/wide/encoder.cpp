#include <string>
#include <utility>

#include "harness/accel/node_order.h"
#include "harness/method/registry.h"
#include "methods/wide/collapse.h"
#include "methods/wide/wide_writer.h"

namespace raystudy::wide {
namespace {

/// Bvh2 → WideBvh of W children a node.
template <int W>
class WideEncoder final : public Encoder {
 public:
  explicit WideEncoder(const Params& params)
      : costs_{.node = static_cast<float>(params.real("node_cost")),
               .leaf = static_cast<float>(params.real("leaf_cost")),
               .triangle = static_cast<float>(params.real("triangle_cost")),
               .most_in_leaf = static_cast<std::uint32_t>(params.integer("max_leaf_triangles"))},
        quantized_(params.text("boxes") == "8-bit"),
        order_(node_order(params.text("layout"))),
        pages_(pages(params.text("pages"))) {}

  static MethodInfo info() {
    const std::string w = std::to_string(W);
    return {
        .name = "bvh" + w,
        .summary = "collapses a binary tree into one of " + w + " children a node, at the least expected cost",
        .citation = "Ylitie, Karras, Laine 2017, Sec. 3.1 (8-bit boxes) and 3.2 (optimal collapse)",
        .params = {choice_param("boxes", {"float", "8-bit"}, "how children's boxes are stored"),
                   integer_param("max_leaf_triangles", 8, "triangles that subtrees may be joined to in a leaf", 1,
                                 WideChild::most_in_leaf),
                   real_param("node_cost", 1, "what a ray pays for an inner node, with the test of its children's boxes", 0, 1e6),
                   real_param("leaf_cost", 0.6, "what it pays for a leaf", 0, 1e6),
                   real_param("triangle_cost", 0.15, "what it pays for each triangle of a leaf", 0, 1e6),
                   choice_param("layout", node_order_names(), "which nodes lie next to each other in memory"),
                   choice_param("pages", pages_names(), "of memory: huge ones where the system grants them, or normal ones")},
        .accel = std::string(WideBvh::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<Accel> encode(const Bvh2& bvh, const Scene& scene, const BuildContext& context) const override {
    auto wide = std::make_unique<WideBvh>();
    const auto encode_all = [&] {
      visit_measure(*context.cost.measure, [&](const auto& measure) {
        const OptimalCollapse<W> collapse(bvh, measure, costs_, context.threads);
        if (quantized_) {
          WideWriter<QuantizedNode<W>, OptimalCollapse<W>>(bvh, scene, collapse).write(*wide, context.threads);
        } else {
          WideWriter<WideNode<W>, OptimalCollapse<W>>(bvh, scene, collapse).write(*wide, context.threads);
        }
      });
    };
    if (context.threads > 1) {
      with_threads(context.threads, encode_all);
    } else {
      encode_all();
    }
    if (order_ != NodeOrder::preorder || pages_ != Pages::huge) arrange(*wide, order_, pages_);  // else it is so already
    return wide;
  }

 private:
  CollapseCosts costs_;
  bool quantized_;
  NodeOrder order_;
  Pages pages_;
};

const Registration<WideEncoder<4>> bvh4;
const Registration<WideEncoder<8>> bvh8;
const Registration<WideEncoder<16>> bvh16;

}  // namespace
}  // namespace raystudy::wide
