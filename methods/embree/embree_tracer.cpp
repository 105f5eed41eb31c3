#include <immintrin.h>
#include <pmmintrin.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "harness/base/unsupported.h"
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

#if RAYSTUDY_EMBREE_STREAMS
/// The rays of a tile, each component in an array of its own: the layout that Embree's streams trace without copying it first.
struct alignas(64) RayStream {
  template <class T>
  using Lane = std::array<T, rays_in_tile>;

  Lane<float> org_x, org_y, org_z, tnear, dir_x, dir_y, dir_z, time, tfar;
  Lane<unsigned> mask, id, flags;
  [[nodiscard]] RTCRayNp pointers() {
    return {org_x.data(), org_y.data(), org_z.data(), tnear.data(), dir_x.data(), dir_y.data(),
            dir_z.data(), time.data(),  tfar.data(),  mask.data(),  id.data(),    flags.data()};
  }
};
struct alignas(64) HitStream {
  RayStream::Lane<float> normal_x, normal_y, normal_z, u, v;
  RayStream::Lane<unsigned> primitive, geometry, instance;
  [[nodiscard]] RTCHitNp pointers() {
    return {normal_x.data(), normal_y.data(),  normal_z.data(), u.data(),
            v.data(),        primitive.data(), geometry.data(), {instance.data()}};
  }
};

void trace_stream(RTCScene scene, bool coherent, std::span<const Ray> rays, std::span<Hit> hits, Query query) {
  QueryFlags query_flags(coherent);
  RayStream stream;
  for (std::size_t i = 0; i < rays.size(); ++i) set_ray(stream, i, rays[i]);
  const auto count = static_cast<unsigned>(rays.size());
  if (query == Query::any_hit) {
    query_flags.occluded(scene, stream.pointers(), count);
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = is_occluded(stream.tfar[i]) ? occluded_hit : Hit{};
    return;
  }
  HitStream found;
  std::fill_n(found.geometry.begin(), rays.size(), RTC_INVALID_GEOMETRY_ID);
  query_flags.intersect(scene, {stream.pointers(), found.pointers()}, count);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    hits[i] =
        found.geometry[i] == RTC_INVALID_GEOMETRY_ID ? Hit{} : Hit{stream.tfar[i], found.primitive[i], found.u[i], found.v[i]};
  }
}
#else
/// EmbreeTracer refuses streams.
void trace_stream(RTCScene, bool, std::span<const Ray>, std::span<Hit>, Query) {}
#endif

}  // namespace

class EmbreeSession final : public TraceSession {
 public:
  /// `width` rays a call: 1, 8, 16, or 0 for a stream.
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
      } else if (width_ == 0) {
        trace_stream(accel_.handle(), coherent_, tile, out, query);
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
  explicit EmbreeTracer(const Params& params)
      : width_(params.text("width") == "stream" ? 0 : std::stoi(params.text("width"))), coherent_(params.text("coherent")) {
    if (width_ != 0 || RAYSTUDY_EMBREE_STREAMS != 0) return;
    throw Unsupported("Embree 4 has no ray streams; expected Embree 3, or a width of 1, 8 or 16");
  }
  static MethodInfo info() {
    return {.name = "embree",
            .summary = "Embree's own traversal: single rays (rtcIntersect1, rtcOccluded1), packets of 8 or 16, or streams",
            .citation = "Wald, Woop, Benthin, Johnson, Ernst 2014, Embree: A Kernel Framework for Efficient CPU Ray Tracing",
            .params = {choice_param("width", {"1", "8", "16", "stream"},
                                    "rays in a packet; stream: rtcIntersectNp, rtcOccludedNp of 1024 rays (Embree 3 only)"),
                       choice_param("coherent", {"auto", "on", "off"},
                                    "Embree's hint that the rays of a call go the same way; auto: as the workload says")},
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
