#include <string>

#include "harness/method/registry.h"
#include "methods/packets/kernels.h"
#include "methods/streams/kernels.h"
#include "methods/wide/session.h"

namespace raystudy::streams {
namespace {

/// Streams of sorted rays through a wide tree.
class StreamTracer final : public Tracer {
 public:
  explicit StreamTracer(const Params& params)
      : simd_(params.text("simd") == "avx2" ? wide::Simd::avx2 : wide::Simd::best),
        coherent_(params.text("coherent")),
        options_{.size = static_cast<std::uint32_t>(std::stoi(params.text("size"))),
                 .block = static_cast<std::uint32_t>(params.integer("block")),
                 .sort = {.origin_bits = static_cast<unsigned>(params.integer("origin_bits")),
                          .direction_bits = static_cast<unsigned>(params.integer("direction_bits"))}} {}

  static MethodInfo info() {
    return {
        .name = "stream",
        .summary = "SIMD, streams of sorted rays through a tree of 4, 8 or 16 children a node; watertight",
        .citation = "Barringer, Akenine-Möller 2014 (ray streams); triangles by Woop, Benthin, Wald 2013",
        .params = {choice_param("size", {"64", "32"}, "rays in a stream"),
                   integer_param("block", 16384, "consecutive rays that are sorted together", 1, 1 << 24),
                   integer_param("origin_bits", 4, "rays of a sector are sorted by 2^bits cells of origin along each axis", 0, 6),
                   integer_param("direction_bits", 0, "and by 2^bits x 2^bits cells of direction", 0, 4),
                   choice_param("coherent", {"auto", "on", "off"},
                                "rays that go the same way are traced as packets of 64; auto: as the workload says"),
                   choice_param("simd", {"auto", "avx2"}, "vector instructions; auto: the widest this processor has")},
        .accel = std::string(WideBvh::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene&, int threads,
                                                      bool coherent) const override {
    const auto& bvh = dynamic_cast<const WideBvh&>(accel);
    if (coherent_ == "auto" ? coherent : coherent_ == "on") {
      return std::make_unique<wide::Session<packets::Kernel>>(bvh, packets::kernel_for(bvh, simd_, {}), threads);
    }
    return std::make_unique<wide::Session<Kernel>>(bvh, kernel_for(bvh, simd_, options_), threads, options_.block);
  }

 private:
  wide::Simd simd_;
  std::string coherent_;
  StreamOptions options_;
};

const Registration<StreamTracer> registration;

}  // namespace
}  // namespace raystudy::streams
