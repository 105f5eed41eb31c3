#include <string>

#include "harness/method/registry.h"
#include "methods/insertion/optimization.h"

namespace raystudy::insertion {
namespace {

class Insertion final : public Optimizer {
 public:
  static MethodInfo info() {
    return {
        .name = "insertion",
        .summary = "removes inner nodes and reinserts their children where they cost least",
        .citation = "Bittner, Hapala, Havran: Fast Insertion-Based Optimization of Bounding Volume Hierarchies, CGF 32(1), 2013",
        .params = {real_param("batch_percent", 1, "k: nodes updated in a pass, % of all nodes", 0.0001, 100),
                   integer_param("p_T", 10, "stops after this many passes without a new least cost", 1, 1e9),
                   integer_param("p_R", 5, "selects at random after this many passes without a new least cost", 1, 1e9),
                   choice_param("selection", {"area-then-random", "area", "random", "metropolis-hastings"},
                                "how a pass selects its nodes"),
                   choice_param("remove", {"both-children", "one-child"}, "what is taken from a selected node"),
                   choice_param("keep", {"last", "best"}, "which tree is the result: the last pass's, or the cheapest"),
                   integer_param("max_passes", 0, "stops after this many passes; 0: no limit", 0, 1e9),
                   real_param("max_seconds", 0, "stops after this time, in seconds; 0: no limit", 0, 1e9)},
        .accel = "bvh2"};
  }

  explicit Insertion(const Params& p) {
    const std::string& selection = p.text("selection");
    options_ = {.batch_percent = p.real("batch_percent"),
                .stop_passes = p.integer("p_T"),
                .random_passes = p.integer("p_R"),
                .selection = selection == "area"                  ? Selection::area
                             : selection == "random"              ? Selection::random
                             : selection == "metropolis-hastings" ? Selection::metropolis_hastings
                                                                  : Selection::area_then_random,
                .both_children = p.text("remove") == "both-children",
                .keep_best = p.text("keep") == "best",
                .max_passes = p.integer("max_passes"),
                .max_seconds = p.real("max_seconds")};
  }

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& measure, auto start) {
      return Optimization(tree, measure, options_, context, start).run();
    });
  }

 private:
  Options options_;
};

const Registration<Insertion> registration;

}  // namespace
}  // namespace raystudy::insertion
