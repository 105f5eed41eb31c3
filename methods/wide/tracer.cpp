#include <atomic>
#include <stdexcept>
#include <string>

#include "harness/method/parallel_rays.h"
#include "harness/method/registry.h"
#include "methods/wide/kernels.h"

namespace raystudy::wide {
namespace {

/// Single rays through a wide tree: every box of a node in one step, every triangle of a leaf in another. Hits are those of
/// testing every triangle, bit for bit, whatever the tree and the instruction set: boxes are tested conservatively (wide_ray.h),
/// triangles as watertight.h does. Of equal t the lowest triangle index is the hit.
class WideSession final : public TraceSession {
 public:
  WideSession(const WideBvh& bvh, Schedule schedule, Simd simd, int threads)
      : tree_(bvh), kernel_(kernel_for(bvh, schedule, simd)), empty_(bvh.empty()), threads_(threads) {}

  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override {
    if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
    for_ray_tiles(rays.size(), threads_, [&](std::size_t begin, std::size_t end) {
      const auto out = hits.subspan(begin, end - begin);
      if (empty_) {
        std::fill(out.begin(), out.end(), Hit{});
      } else {
        kernel_.trace(tree_, rays.subspan(begin, end - begin), out, query);
      }
    });
  }

  [[nodiscard]] bool counts() const override { return true; }

  TraceCounts count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) override {
    if (!steps.empty() && steps.size() != rays.size()) throw std::logic_error("as many step counts as rays are needed, or none");
    if (empty_) {
      std::fill(steps.begin(), steps.end(), 0U);
      return {};
    }
    return kernel_.count(tree_, rays, query, steps);
  }

 private:
  Tree tree_;
  Kernel kernel_;
  bool empty_;
  int threads_;
};

class WideTracer final : public Tracer {
 public:
  explicit WideTracer(const Params& params)
      : schedule_(params.text("schedule")), simd_(params.text("simd") == "avx2" ? Simd::avx2 : Simd::best) {}

  static MethodInfo info() {
    return {
        .name = "wide",
        .summary = "SIMD, one ray at a time through a tree of 4, 8 or 16 children a node; watertight",
        .citation = "Wald, Benthin, Boulos 2008; triangles by Woop, Benthin, Wald 2013; any hit by Nah and Manocha 2014 (SATO)",
        .params = {choice_param(
                       "schedule", {"auto", "one-by-one", "in-turns"},
                       "rays one after another, or many in turns; auto: in turns where they are incoherent and there is AVX-512"),
                   choice_param("simd", {"auto", "avx2"}, "vector instructions; auto: the widest this processor has")},
        .accel = std::string(WideBvh::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene&, int threads,
                                                      bool coherent) const override {
    // Without the compressing stores of AVX-512, turns cost more than they gain.
    const bool can_compress = simd_ == Simd::best && best_simd() == "AVX-512";
    const bool in_turns = schedule_ == "auto" ? !coherent && can_compress : schedule_ == "in-turns";
    const Schedule schedule = in_turns ? Schedule::in_turns : Schedule::one_by_one;
    return std::make_unique<WideSession>(dynamic_cast<const WideBvh&>(accel), schedule, simd_, threads);
  }

 private:
  std::string schedule_;
  Simd simd_;
};

const Registration<WideTracer> registration;

}  // namespace
}  // namespace raystudy::wide
