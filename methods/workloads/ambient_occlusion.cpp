#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "harness/geometry/sampling.h"
#include "harness/method/registry.h"
#include "methods/workloads/camera_rays.h"

namespace raystudy::workloads {
namespace {

/// How far a float of this magnitude may be wrong, with room for the few roundings of a hit point: 2⁻²⁰ of it, some 16 ulp.
float offset_of(Vec3 p, float diagonal) {
  return 0x1p-20F * std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z), diagonal});
}

/// The unit normal of a triangle with edges `ab` and `ac` on the side the ray of direction `seen_along` comes from. In double,
/// where the product of floats neither overflows nor underflows; a triangle of no area gives the direction back to the camera.
Vec3 facing_normal(Vec3 ab, Vec3 ac, Vec3 seen_along) {
  const auto product = [](float a, float b) { return static_cast<double>(a) * static_cast<double>(b); };
  const double x = product(ab.y, ac.z) - product(ab.z, ac.y);
  const double y = product(ab.z, ac.x) - product(ab.x, ac.z);
  const double z = product(ab.x, ac.y) - product(ab.y, ac.x);
  const double size = std::sqrt(x * x + y * y + z * z);
  if (!(size > 0)) return -normalized(seen_along);
  const Vec3 normal{static_cast<float>(x / size), static_cast<float>(y / size), static_cast<float>(z / size)};
  return dot(normal, seen_along) > 0 ? -normal : normal;
}

}  // namespace

/// Any-hit rays from each primary hit, cosine-distributed about the normal that faces the camera. The hit point is interpolated
/// from the triangle's corners (more exact than origin + t · direction), and the origin lifted along the normal by 2⁻²⁰ of the
/// larger of its coordinates and the scene's diagonal, so that no ray meets the triangle it starts from.
class AmbientOcclusion final : public Workload {
 public:
  explicit AmbientOcclusion(const Params& params)
      : options_(params),
        rays_(static_cast<std::uint32_t>(params.integer("rays"))),
        length_(static_cast<float>(params.real("length"))) {}
  static MethodInfo info() {
    std::vector<ParamSpec> params = camera_params();
    params.push_back(integer_param("rays", 10, "rays from each primary hit", 1, 4096));
    ParamSpec length = real_param("length", 0.1, "length of the rays as a share of the scene's diagonal", 0, 1e3);
    length.lowest_is_open = true;
    params.push_back(std::move(length));
    return {.name = "ambient-occlusion",
            .summary = "any hits of cosine-distributed rays of limited length from each primary hit",
            .citation = "Bittner, Hapala, Havran 2015, section 3 (ambient occlusion rays: ten at each hit)",
            .params = std::move(params)};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext& context) const override {
    if (!context.closest_hits) throw std::logic_error("ambient-occlusion needs WorkloadContext::closest_hits");
    const RayBatch camera = camera_rays(scene, options_, context.seed);
    std::vector<Hit> hits(camera.rays.size());
    context.closest_hits(camera.rays, hits);

    RayBatch batch;
    batch.query = Query::any_hit;
    batch.width = camera.width;
    batch.height = camera.height;
    const auto hit_count =
        static_cast<std::size_t>(std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); }));
    batch.rays.reserve(hit_count * rays_);
    batch.ray_pixels.reserve(hit_count * rays_);
    const IndexedRandom random(context.seed, 2);
    for (std::size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].is_hit()) add_rays(scene, camera, i, hits[i], random, batch);
    }
    return batch;
  }

 private:
  void add_rays(const Scene& scene, const RayBatch& camera, std::size_t i, const Hit& hit, const IndexedRandom& random,
                RayBatch& batch) const {
    const Triangle& triangle = scene.triangles[hit.triangle];
    const Vec3 a = scene.vertices[triangle[0]];
    const Vec3 ab = scene.vertices[triangle[1]] - a;
    const Vec3 ac = scene.vertices[triangle[2]] - a;
    const Vec3 normal = facing_normal(ab, ac, camera.rays[i].direction);
    const Vec3 point = a + hit.u * ab + hit.v * ac;
    const float diagonal = scene.diagonal();
    const Frame frame(normal);
    for (std::uint32_t k = 0; k < rays_; ++k) {
      const std::uint64_t index = 2 * (std::uint64_t{i} * rays_ + k);
      Ray ray;
      ray.origin = point + offset_of(point, diagonal) * normal;
      ray.direction = frame.to_world(cosine_direction(random.uniform(index), random.uniform(index + 1)));
      ray.tmax = length_ * diagonal;
      batch.rays.push_back(ray);
      batch.ray_pixels.push_back(camera.ray_pixels[i]);
    }
  }

  CameraOptions options_;
  std::uint32_t rays_;
  float length_;
};

const Registration<AmbientOcclusion> ambient_occlusion;

}  // namespace raystudy::workloads
