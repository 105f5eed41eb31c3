#include "methods/workloads/surface_points.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

std::vector<SurfacePoint> surface_points(const Scene& scene, const CameraOptions& options, const WorkloadContext& context) {
  if (!context.closest_hits) throw std::logic_error("rays from surfaces need WorkloadContext::closest_hits");
  const RayBatch camera = camera_rays(scene, options, context.seed);
  std::vector<Hit> hits(camera.rays.size());
  context.closest_hits(camera.rays, hits);

  std::vector<SurfacePoint> points;
  points.reserve(static_cast<std::size_t>(std::count_if(hits.begin(), hits.end(), [](const Hit& h) { return h.is_hit(); })));
  const float diagonal = scene.diagonal();
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (!hits[i].is_hit()) continue;
    const Triangle& triangle = scene.triangles[hits[i].triangle];
    const Vec3 a = scene.vertices[triangle[0]];
    const Vec3 ab = scene.vertices[triangle[1]] - a;
    const Vec3 ac = scene.vertices[triangle[2]] - a;
    const Vec3 position = a + hits[i].u * ab + hits[i].v * ac;
    const Vec3 seen_along = camera.rays[i].direction;
    points.push_back(
        {position, facing_normal(ab, ac, seen_along), seen_along, offset_of(position, diagonal), i, camera.ray_pixels[i]});
  }
  return points;
}

RayBatch secondary_batch(const CameraOptions& options, Query query, std::size_t rays) {
  RayBatch batch;
  batch.query = query;
  batch.width = options.width;
  batch.height = options.height;
  batch.rays.reserve(rays);
  batch.ray_pixels.reserve(rays);
  return batch;
}

}  // namespace raystudy::workloads
