#include <string>

#include "harness/base/parallel.h"
#include "harness/method/registry.h"
#include "methods/insertion/parallel_optimization.h"

namespace raystudy::insertion {
namespace {

class InsertionParallel final : public Optimizer {
 public:
  static MethodInfo info() {
    return {
        .name = "insertion-parallel",
        .summary = "searches in parallel for better places of many nodes, and reinserts those that do not conflict",
        .citation = "Meister, Bittner: Parallel Reinsertion for Bounding Volume Hierarchy Optimization, CGF 37(2), 2018",
        .params = {choice_param(
                       "candidates", {"potential", "area", "modulo"},
                       "what a pass looks at: the foremost by what they could gain, or by area; or every mu-th (the paper)"),
                   choice_param("remove", {"nodes-and-children", "nodes"},
                                "what is taken out: single nodes (the paper), and with them both children of a node together"),
                   real_param("first_percent", 0.3, "share of the candidates in the first passes, %", 1e-6, 100),
                   real_param("last_percent", 10, "share of the candidates in the last passes, %", 1e-6, 100),
                   real_param("growth", 3, "from a share to the next", 1.01, 1e9),
                   integer_param("mu", 8, "with candidates: modulo, the first mu; falls to 1", 1, 1 << 20),
                   choice_param("search", {"changed", "all"},
                                "whether a pass leaves out what has nothing new about it since it was looked at, or does not"),
                   choice_param("conflicts", {"nodes", "paths"},
                                "what excludes another reinsertion: the nodes that it touches, or its whole path"),
                   integer_param("batch", 500, "candidates searched in the same tree, before what was found is applied", 1, 1e9),
                   real_param("loss", 0.2,
                              "how much more than what both children free their insertion may seem to cost, as a share of it; "
                              "in the last passes 0",
                              0, 1e9),
                   real_param("tolerance_percent", 0.05, "least fall of the cost in a pass that is worth another like it, %", 0,
                              100),
                   integer_param("max_passes", 0, "stops after this many passes; 0: no limit", 0, 1e9),
                   real_param("max_seconds", 0, "stops after this time, in seconds; 0: no limit", 0, 1e9)},
        .accel = "bvh2"};
  }

  explicit InsertionParallel(const Params& p) {
    const std::string& candidates = p.text("candidates");
    options_ = {.modulo = candidates == "modulo",
                .ranking = candidates == "area" ? Ranking::area : Ranking::potential,
                .children = p.text("remove") == "nodes-and-children",
                .first_percent = p.real("first_percent"),
                .last_percent = p.real("last_percent"),
                .growth = p.real("growth"),
                .mu = p.integer("mu"),
                .changed_only = p.text("search") == "changed",
                .path_conflicts = p.text("conflicts") == "paths",
                .batch = p.integer("batch"),
                .loss = p.real("loss"),
                .tolerance = p.real("tolerance_percent") / 100,
                .max_passes = p.integer("max_passes"),
                .max_seconds = p.real("max_seconds")};
  }

  void optimize(Bvh2& bvh, const Scene& /*scene*/, const BuildContext& context) const override {
    with_threads(context.threads, [&] {
      edit_as_pairs(bvh, context, [&](PairTree& tree, const auto& measure, auto start) {
        return ParallelOptimization(tree, measure, options_, context, start).run();
      });
    });
  }

 private:
  ParallelOptions options_;
};

const Registration<InsertionParallel> registration;

}  // namespace
}  // namespace raystudy::insertion
