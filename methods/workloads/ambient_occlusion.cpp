#include "harness/geometry/sampling.h"
#include "harness/method/registry.h"
#include "methods/workloads/surface_points.h"

namespace raystudy::workloads {

/// Any-hit rays from each primary hit, cosine-distributed about the normal that faces the camera.
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
    const std::vector<SurfacePoint> points = surface_points(scene, options_, context);
    RayBatch batch = secondary_batch(options_, Query::any_hit, points.size() * rays_);
    const IndexedRandom random(context.seed, 2);
    for (const SurfacePoint& point : points) {
      const Frame frame(point.normal);
      for (std::uint32_t k = 0; k < rays_; ++k) {
        const std::uint64_t index = 2 * (point.ray * rays_ + k);
        Ray ray;
        ray.origin = point.position + point.offset * point.normal;
        ray.direction = frame.to_world(cosine_direction(random.uniform(index), random.uniform(index + 1)));
        ray.tmax = length_ * scene.diagonal();
        batch.rays.push_back(ray);
        batch.ray_pixels.push_back(point.pixel);
      }
    }
    return batch;
  }

 private:
  CameraOptions options_;
  std::uint32_t rays_;
  float length_;
};

const Registration<AmbientOcclusion> ambient_occlusion;

}  // namespace raystudy::workloads
