#include <immintrin.h>
#include <pmmintrin.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "harness/method/parallel_rays.h"
#include "harness/method/registry.h"
#include "methods/embree/embree_accel.h"

namespace raystudy::embree {
namespace {

/// Denormals are flushed to zero while this lives, as Embree's manual advises for its callers, and then as before.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

constexpr Hit occluded_hit{0, 0, 0, 0};  // any hit: `triangle` only says that there is one

void set_ray(RTCRay& out, const Ray& ray) {
  out.org_x = ray.origin.x;
  out.org_y = ray.origin.y;
  out.org_z = ray.origin.z;
  out.tnear = ray.tmin;
  out.dir_x = ray.direction.x;
  out.dir_y = ray.direction.y;
  out.dir_z = ray.direction.z;
  out.time = 0;
  out.tfar = ray.tmax;
  out.mask = ~0U;
  out.id = 0;
  out.flags = 0;
}

template <class Packet>
void set_ray(Packet& out, std::size_t i, const Ray& ray) {
  out.org_x[i] = ray.origin.x;
  out.org_y[i] = ray.origin.y;
  out.org_z[i] = ray.origin.z;
  out.tnear[i] = ray.tmin;
  out.dir_x[i] = ray.direction.x;
  out.dir_y[i] = ray.direction.y;
  out.dir_z[i] = ray.direction.z;
  out.time[i] = 0;
  out.tfar[i] = ray.tmax;
  out.mask[i] = ~0U;
  out.id[i] = 0;
  out.flags[i] = 0;
}

/// Where Embree found nothing it leaves geomID invalid; tfar of an occluded ray becomes -inf.
bool is_occluded(float tfar) { return tfar < 0; }

}  // namespace

class EmbreeSession final : public TraceSession {
 public:
  EmbreeSession(const EmbreeAccel& accel, int width, int threads, bool coherent)
      : accel_(accel), width_(width), threads_(threads), coherent_(coherent) {}

  /// Not even with the robust flag: rays aimed exactly at a vertex have been seen to pass between its triangles.
  [[nodiscard]] bool watertight() const override { return false; }
  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override {
    if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
    for_ray_tiles(rays.size(), threads_, [&](std::size_t begin, std::size_t end) {
      const FlushDenormals flush;
      const auto tile = rays.subspan(begin, end - begin);
      const auto out = hits.subspan(begin, end - begin);
      if (width_ == 1) {
        trace_single(tile, out, query);
      } else if (width_ == 8) {
        trace_packets<RTCRayHit8, RTCRay8, 8>(tile, out, query);
      } else {
        trace_packets<RTCRayHit16, RTCRay16, 16>(tile, out, query);
      }
    });
    accel_.device().check("tracing");
  }

 private:
  void trace_single(std::span<const Ray> rays, std::span<Hit> hits, Query query) const {
    QueryFlags flags(coherent_);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (query == Query::any_hit) {
        RTCRay ray;
        set_ray(ray, rays[i]);
        flags.occluded(accel_.handle(), nullptr, ray);
        hits[i] = is_occluded(ray.tfar) ? occluded_hit : Hit{};
      } else {
        RTCRayHit ray;
        set_ray(ray.ray, rays[i]);
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        flags.intersect(accel_.handle(), nullptr, ray);
        hits[i] = ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? Hit{} : Hit{ray.ray.tfar, ray.hit.primID, ray.hit.u, ray.hit.v};
      }
    }
  }

  template <class RayHitPacket, class RayPacket, std::size_t width>
  void trace_packets(std::span<const Ray> rays, std::span<Hit> hits, Query query) const {
    QueryFlags flags(coherent_);
    alignas(64) std::array<int, width> valid;
    for (std::size_t begin = 0; begin < rays.size(); begin += width) {
      const std::size_t count = std::min(width, rays.size() - begin);
      // Lanes past the end repeat the last ray, switched off.
      for (std::size_t i = 0; i < width; ++i) valid[i] = i < count ? -1 : 0;
      if (query == Query::any_hit) {
        RayPacket packet;
        for (std::size_t i = 0; i < width; ++i) set_ray(packet, i, rays[begin + std::min(i, count - 1)]);
        flags.occluded(accel_.handle(), valid.data(), packet);
        for (std::size_t i = 0; i < count; ++i) hits[begin + i] = is_occluded(packet.tfar[i]) ? occluded_hit : Hit{};
      } else {
        RayHitPacket packet;
        for (std::size_t i = 0; i < width; ++i) {
          set_ray(packet.ray, i, rays[begin + std::min(i, count - 1)]);
          packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        flags.intersect(accel_.handle(), valid.data(), packet);
        for (std::size_t i = 0; i < count; ++i) {
          hits[begin + i] = packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID
                                ? Hit{}
                                : Hit{packet.ray.tfar[i], packet.hit.primID[i], packet.hit.u[i], packet.hit.v[i]};
        }
      }
    }
  }

  const EmbreeAccel& accel_;
  int width_;
  int threads_;
  bool coherent_;
};

class EmbreeTracer final : public Tracer {
 public:
  explicit EmbreeTracer(const Params& params) : width_(std::stoi(params.text("width"))), coherent_(params.text("coherent")) {}
  static MethodInfo info() {
    return {.name = "embree",
            .summary = "Embree's own traversal: single rays (rtcIntersect1, rtcOccluded1) or packets of 8 or 16",
            .citation = "Wald, Woop, Benthin, Johnson, Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray Tracing",
            .params = {choice_param("width", {"1", "8", "16"}, "rays in a packet"),
                       choice_param("coherent", {"auto", "on", "off"},
                                    "Embree's hint that the rays of a packet go the same way; auto: as the workload says")},
            .accel = std::string(EmbreeAccel::kind_name)};
  }
  [[nodiscard]] std::unique_ptr<TraceSession> prepare(const Accel& accel, const Scene&, int threads,
                                                      bool coherent) const override {
    return std::make_unique<EmbreeSession>(dynamic_cast<const EmbreeAccel&>(accel), width_, threads,
                                           coherent_ == "auto" ? coherent : coherent_ == "on");
  }

 private:
  int width_;
  std::string coherent_;
};

const Registration<EmbreeTracer> embree_tracer;

}  // namespace raystudy::embree
