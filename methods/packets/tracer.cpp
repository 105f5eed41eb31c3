#include <string>

#include "harness/method/registry.h"
#include "methods/packets/kernels.h"
#include "methods/wide/session.h"

namespace raystudy::packets {
namespace {

Culling culling_of(const std::string& text) {
  if (text == "none") return Culling::none;
  return text == "frustum" ? Culling::frustum : Culling::interval;
}

/// Packets of consecutive rays through a wide tree.
class PacketTracer final : public Tracer {
 public:
  explicit PacketTracer(const Params& params)
      : simd_(params.text("simd") == "avx2" ? wide::Simd::avx2 : wide::Simd::best),
        options_{.size = static_cast<std::uint32_t>(std::stoi(params.text("size"))),
                 .culling = culling_of(params.text("culling")),
                 .first_active = params.boolean("first_active")} {}

  static MethodInfo info() {
    return {
        .name = "packet",
        .summary = "SIMD, packets of consecutive rays through a tree of 4, 8 or 16 children a node; watertight",
        .citation = "Wald, Boulos, Shirley 2007, Sec. 3; Lauterbach 2010, Sec. 4.2; frusta by Reshetov, Soupikov, Hurley 2005",
        .params = {choice_param("size", {"64", "4", "16", "256"}, "rays in a packet: 8 x 8, 2 x 2, 4 x 4 or 16 x 16"),
                   choice_param("culling", {"interval", "frustum", "none"},
                                "how a node's children are tested against a packet as a whole before its rays"),
                   boolean_param("first_active", true,
                                 "a child is entered for the first rays found to meet it; else all are tested"),
                   choice_param("simd", {"auto", "avx2"}, "vector instructions; auto: the widest this processor has")},
        .accel = std::string(WideBvh::kind_name)};
  }

  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene&, int threads, bool) const override {
    const auto& bvh = dynamic_cast<const WideBvh&>(accel);
    return std::make_unique<wide::Session<Kernel>>(bvh, kernel_for(bvh, simd_, options_), threads);
  }

 private:
  wide::Simd simd_;
  PacketOptions options_;
};

const Registration<PacketTracer> registration;

}  // namespace
}  // namespace raystudy::packets
