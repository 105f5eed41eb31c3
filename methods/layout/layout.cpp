#include <chrono>

#include "harness/accel/node_order.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// Moves a tree's nodes in memory. An optimizer, so that it can be the last of any pipeline of binary trees.
class Layout final : public Optimizer {
 public:
  static MethodInfo info() {
    return {.name = "layout",
            .summary = "puts the nodes of a tree into another order in memory; the tree stays the same",
            .citation = "Prokop: Cache-Oblivious Algorithms, 1999, Section 3 (van Emde Boas)",
            .params = {choice_param("order", node_order_names(), "which pairs of siblings lie next to each other"),
                       choice_param("pages", pages_names(), "of memory: huge ones where the system grants them, or normal ones")},
            .accel = "bvh2"};
  }

  explicit Layout(const Params& p) : order_(node_order(p.text("order"))), pages_(pages(p.text("pages"))) {}

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    arrange(bvh, order_, pages_);
    if (context.cost_trace == nullptr) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double cost = tree_cost(bvh, context.cost);
    context.cost_trace->push_back({0, cost});
    context.cost_trace->push_back({seconds, cost});
  }

 private:
  NodeOrder order_;
  Pages pages_;
};

const Registration<Layout> registration;

}  // namespace
}  // namespace raystudy
