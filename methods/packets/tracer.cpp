#include <algorithm>
#include <stdexcept>
#include <string>

#include "harness/method/parallel_rays.h"
#include "harness/method/registry.h"
#include "methods/packets/kernels.h"

namespace raystudy::packets {
namespace {

/// Packets of consecutive rays through a wide tree. Hits are those of testing every triangle, bit for bit, whatever the tree, the
/// packets and the instruction set: boxes are tested conservatively, triangles as watertight.h does. Of equal t the lowest
/// triangle index is the hit.
class PacketSession final : public TraceSession {
 public:
  PacketSession(const WideBvh& bvh, wide::Simd simd, const PacketOptions& options, int threads)
      : tree_(bvh), options_(options), kernel_(kernel_for(bvh, simd, options.size)), empty_(bvh.empty()), threads_(threads) {}

  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override {
    if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
    for_ray_tiles(rays.size(), threads_, [&](std::size_t begin, std::size_t end) {
      const auto out = hits.subspan(begin, end - begin);
      if (empty_) {
        std::fill(out.begin(), out.end(), Hit{});
      } else {
        kernel_.trace(tree_, options_, rays.subspan(begin, end - begin), out, query);
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
    return kernel_.count(tree_, options_, rays, query, steps);
  }

 private:
  wide::Tree tree_;
  PacketOptions options_;
  Kernel kernel_;
  bool empty_;
  int threads_;
};

Culling culling_of(const std::string& text) {
  if (text == "none") return Culling::none;
  return text == "frustum" ? Culling::frustum : Culling::interval;
}

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
    return std::make_unique<PacketSession>(dynamic_cast<const WideBvh&>(accel), simd_, options_, threads);
  }

 private:
  wide::Simd simd_;
  PacketOptions options_;
};

const Registration<PacketTracer> registration;

}  // namespace
}  // namespace raystudy::packets
