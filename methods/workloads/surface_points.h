#pragma once

#include <cstdint>
#include <vector>

#include "harness/geometry/ray.h"
#include "harness/method/method.h"
#include "harness/scene/scene.h"
#include "methods/workloads/camera_rays.h"

namespace raystudy::workloads {

/// What a camera ray hit: where secondary rays start.
struct SurfacePoint {
  Vec3 position;      ///< interpolated from the triangle's corners, more exact than origin + t · direction
  Vec3 normal;        ///< of the triangle, of unit length, on the side of the camera; back to the camera where it has no area
  Vec3 seen_along;    ///< direction of the camera ray
  float offset = 0;   ///< 2⁻²⁰ of the larger of the position's coordinates and the scene's diagonal
  std::uint64_t ray;  ///< index of the camera ray
  std::uint32_t pixel;

  /// An origin so far off the surface, on the side that `direction` leaves to, that no ray meets the triangle it starts from.
  [[nodiscard]] Vec3 origin_towards(Vec3 direction) const {
    return position + (dot(direction, normal) < 0 ? -offset : offset) * normal;
  }
};

/// The points that the camera's rays hit, in the order of the rays. Throws std::logic_error without
/// WorkloadContext::closest_hits.
[[nodiscard]] std::vector<SurfacePoint> surface_points(const Scene& scene, const CameraOptions& options,
                                                       const WorkloadContext& context);

/// An empty batch for `rays` rays of the camera's pixels.
[[nodiscard]] RayBatch secondary_batch(const CameraOptions& options, Query query, std::size_t rays);

}  // namespace raystudy::workloads
