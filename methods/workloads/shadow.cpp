#include <cmath>
#include <numbers>

#include "harness/geometry/sampling.h"
#include "harness/method/registry.h"
#include "methods/workloads/surface_points.h"

namespace raystudy::workloads {
namespace {

/// Where a ray to a point light ends, as a share of the way: just before the light, which may lie in a lamp's surface.
constexpr float light_share = 1 - 0x1p-10F;

/// A uniformly distributed unit vector from two uniform numbers in [0, 1).
Vec3 sphere_direction(float a, float b) {
  const float z = 1 - 2 * a;
  const float radius = std::sqrt(max(0.0F, 1 - z * z));
  const float angle = 2 * std::numbers::pi_v<float> * b;
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

}  // namespace

/// Any-hit rays from each primary hit to the scene's lights in turn. A light is a sphere about its position; a directional one
/// is a sphere one diagonal away, and its rays go on without end. A ray leaves the surface on the side of its light, so that each
/// hit has as many rays whichever way it faces.
class Shadow final : public Workload {
 public:
  explicit Shadow(const Params& params)
      : options_(params),
        rays_(static_cast<std::uint32_t>(params.integer("rays"))),
        radius_(static_cast<float>(params.real("radius"))) {}
  static MethodInfo info() {
    std::vector<ParamSpec> params = camera_params();
    params.push_back(integer_param("rays", 2, "rays from each primary hit, spread over the lights in turn", 1, 4096));
    params.push_back(
        real_param("radius", 0, "radius of the lights as a share of the scene's diagonal; rays end on their surface", 0, 0.5));
    return {.name = "shadow",
            .summary = "any hits of rays from each primary hit to the scene's lights",
            .citation = "Bittner and Meister 2015, section 6.2 (two shadow rays)",
            .params = std::move(params)};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext& context) const override {
    const std::vector<SurfacePoint> points = surface_points(scene, options_, context);
    RayBatch batch = secondary_batch(options_, Query::any_hit, points.size() * rays_);
    const IndexedRandom random(context.seed, 3);
    for (const SurfacePoint& point : points) {
      for (std::uint32_t k = 0; k < rays_; ++k) {
        const std::uint64_t index = point.ray * rays_ + k;
        const Vec3 within = radius_ * sphere_direction(random.uniform(2 * index), random.uniform(2 * index + 1));
        batch.rays.push_back(ray_to(scene.lights[index % scene.lights.size()], point, within, scene.diagonal()));
        batch.ray_pixels.push_back(point.pixel);
      }
    }
    return batch;
  }

 private:
  /// `within`: the point of the light's sphere that is aimed at, from its centre, in diagonals.
  static Ray ray_to(const Light& light, const SurfacePoint& point, Vec3 within, float diagonal) {
    Ray ray;
    if (light.point_at_infinity) {
      ray.direction = normalized(light.position) + within;
      ray.origin = point.origin_towards(ray.direction);
    } else {
      const Vec3 target = light.position + diagonal * within;
      ray.origin = point.origin_towards(target - point.position);
      ray.direction = target - ray.origin;
      ray.tmax = light_share;
    }
    return ray;
  }

  CameraOptions options_;
  std::uint32_t rays_;
  float radius_;
};

const Registration<Shadow> shadow;

}  // namespace raystudy::workloads
