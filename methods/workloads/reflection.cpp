#include "harness/method/registry.h"
#include "methods/workloads/surface_points.h"

namespace raystudy::workloads {

/// One closest-hit ray from each primary hit: the camera ray mirrored by the triangle, as if all surfaces were mirrors.
class Reflection final : public Workload {
 public:
  explicit Reflection(const Params& params) : options_(params) {}
  static MethodInfo info() {
    return {.name = "reflection",
            .summary = "closest hits of the camera's rays mirrored by the triangles they hit",
            .citation = "Lauterbach 2010, section 4.2.3 (secondary rays: shadows and reflections)",
            .params = camera_params()};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext& context) const override {
    const std::vector<SurfacePoint> points = surface_points(scene, options_, context);
    RayBatch batch = secondary_batch(options_, Query::closest_hit, points.size());
    for (const SurfacePoint& point : points) {
      Ray ray;
      ray.origin = point.position + point.offset * point.normal;
      ray.direction = normalized(point.seen_along - 2 * dot(point.seen_along, point.normal) * point.normal);
      batch.rays.push_back(ray);
      batch.ray_pixels.push_back(point.pixel);
    }
    return batch;
  }

 private:
  CameraOptions options_;
};

const Registration<Reflection> reflection;

}  // namespace raystudy::workloads
