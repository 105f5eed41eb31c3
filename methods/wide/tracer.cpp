#include <string>

#include "harness/method/registry.h"
#include "methods/wide/session.h"

namespace raystudy::wide {
namespace {

/// Single rays through a wide tree: every box of a node in one step, every triangle of a leaf in another.
class WideTracer final : public Tracer {
 public:
  explicit WideTracer(const Params& params)
      : schedule_(params.text("schedule")), simd_(params.text("simd") == "avx2" ? Simd::avx2 : Simd::best) {}

  static MethodInfo info() {
    return {
        .name = "wide",
        .summary = "SIMD, one ray at a time through a tree of 4, 8 or 16 children a node; watertight",
        .citation = "Wald, Benthin, Boulos 2008; triangles by Woop, Benthin, Wald 2013; any hit by Nah and Manocha 2014 (SATO)",
        .params = {choice_param("schedule", {"auto", "one-by-one", "in-turns"},
                                "rays one after another, or many in turns; auto: with AVX-512 in turns, but coherent ones in a "
                                "tree of less than 16 MiB"),
                   choice_param("simd", {"auto", "avx2"}, "vector instructions; auto: the widest this processor has")},
        .accel = std::string(WideBvh::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene&, int threads,
                                                      bool coherent) const override {
    const auto& bvh = dynamic_cast<const WideBvh&>(accel);
    Schedule schedule = schedule_ == "in-turns" ? Schedule::in_turns : Schedule::one_by_one;
    // Without the compressing stores of AVX-512, turns cost more than they gain.
    const bool can_compress = simd_ == Simd::best && best_simd() == "AVX-512";
    if (schedule_ == "auto" && can_compress) schedule = best_schedule(coherent, bvh.bytes());
    return std::make_unique<Session<Kernel>>(bvh, kernel_for(bvh, schedule, simd_), threads);
  }

 private:
  std::string schedule_;
  Simd simd_;
};

const Registration<WideTracer> registration;

}  // namespace
}  // namespace raystudy::wide
