#pragma once

#include <vector>

#include "harness/geometry/ray.h"
#include "harness/method/method.h"
#include "harness/scene/scene.h"

namespace raystudy::workloads {

/// The parameters that every workload with a camera shares: camera, width, height, samples, order.
[[nodiscard]] std::vector<ParamSpec> camera_params();

struct CameraOptions {
  explicit CameraOptions(const Params& params);
  std::string camera;
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t samples;  ///< rays a pixel: 1 through its centre, more uniformly random over it
  bool tiles;             ///< in Morton order within tiles of 8 × 8 pixels, as renderers trace, else line by line
};

/// Camera rays of unit direction. RayBatch::ray_pixels is filled; a pixel's samples stand together.
[[nodiscard]] RayBatch camera_rays(const Scene& scene, const CameraOptions& options, std::uint64_t seed);

}  // namespace raystudy::workloads
