#include "harness/geometry/sampling.h"
#include "harness/method/registry.h"

namespace raystudy::workloads {

/// Rays through two points distributed uniformly and independently over the scene's bounding box. Where the lecture leaves open
/// what becomes of the two points, the first is the origin and the ray goes on without end through the second; with `segment` it
/// ends there.
class Random final : public Workload {
 public:
  explicit Random(const Params& params)
      : count_(static_cast<std::size_t>(params.integer("count"))), segment_(params.boolean("segment")) {}
  static MethodInfo info() {
    return {.name = "random",
            .summary = "closest hits of rays through two uniformly distributed points of the scene's bounding box",
            .citation = "Bittner, Hapala, Havran 2015, section 3 (random rays; 8 million in the paper)",
            .params = {integer_param("count", 1000000, "number of rays", 1, 1e9),
                       boolean_param("segment", false, "the ray ends at the second point instead of going on")}};
  }
  [[nodiscard]] RayBatch generate(const Scene& scene, const WorkloadContext& context) const override {
    const IndexedRandom random(context.seed, 1);
    const Vec3 extent = scene.bounds.extent();
    const auto point = [&](std::uint64_t i) {
      return scene.bounds.lower + extent * Vec3{random.uniform(i), random.uniform(i + 1), random.uniform(i + 2)};
    };
    RayBatch batch;
    batch.rays.resize(count_);
    for (std::size_t i = 0; i < count_; ++i) {
      Ray& ray = batch.rays[i];
      ray.origin = point(6 * i);
      ray.direction = point(6 * i + 3) - ray.origin;
      if (segment_) ray.tmax = 1;
    }
    return batch;
  }

 private:
  std::size_t count_;
  bool segment_;
};

const Registration<Random> random_rays;

}  // namespace raystudy::workloads
