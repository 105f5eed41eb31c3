#include "methods/workloads/camera_rays.h"

#include <cmath>
#include <numbers>

#include "harness/geometry/sampling.h"

namespace raystudy::workloads {
namespace {

constexpr std::uint32_t tile_edge = 8;

/// The pixels of a width × height image in the order their rays are made.
std::vector<std::uint32_t> pixel_order(std::uint32_t width, std::uint32_t height, bool tiles) {
  std::vector<std::uint32_t> order;
  order.reserve(std::size_t{width} * height);
  if (!tiles) {
    for (std::uint32_t p = 0; p < width * height; ++p) order.push_back(p);
    return order;
  }
  const auto every_second_bit = [](std::uint32_t i) { return (i & 1U) | ((i >> 1U) & 2U) | ((i >> 2U) & 4U); };
  for (std::uint32_t top = 0; top < height; top += tile_edge) {
    for (std::uint32_t left = 0; left < width; left += tile_edge) {
      for (std::uint32_t i = 0; i < tile_edge * tile_edge; ++i) {
        const std::uint32_t x = left + every_second_bit(i);
        const std::uint32_t y = top + every_second_bit(i >> 1U);
        if (x < width && y < height) order.push_back(y * width + x);
      }
    }
  }
  return order;
}

/// The image plane at distance 1, y upwards.
struct ImagePlane {
  Vec3 forward, right, up;
  ImagePlane(const Camera& camera, std::uint32_t width, std::uint32_t height) {
    forward = normalized(camera.target - camera.eye);
    Vec3 side = cross(forward, camera.up);
    // A camera that looks along its up vector still has an image; which way round it stands is then arbitrary.
    if (!(dot(side, side) > 1e-12F * dot(camera.up, camera.up))) side = Frame(forward).tangent;
    const float half_height = std::tan(camera.vertical_fov * (std::numbers::pi_v<float> / 360));
    right = normalized(side) * (half_height * static_cast<float>(width) / static_cast<float>(height));
    up = normalized(cross(side, forward)) * half_height;
  }
  /// x and y in [0, 1] from the left and from the top.
  [[nodiscard]] Vec3 direction(float x, float y) const { return normalized(forward + (2 * x - 1) * right + (1 - 2 * y) * up); }
};

}  // namespace

std::vector<ParamSpec> camera_params() {
  return {text_param("camera", "", "name of the scene's camera; empty: its first"),
          integer_param("width", 640, "image width in pixels", 1, 16384),
          integer_param("height", 480, "image height in pixels", 1, 16384),
          integer_param("samples", 1, "rays a pixel: 1 goes through its centre, more are spread over it at random", 1, 4096),
          choice_param("order", {"tiles", "lines"}, "order of the rays: Morton order in tiles of 8 x 8 pixels, or line by line")};
}

CameraOptions::CameraOptions(const Params& params)
    : camera(params.text("camera")),
      width(static_cast<std::uint32_t>(params.integer("width"))),
      height(static_cast<std::uint32_t>(params.integer("height"))),
      samples(static_cast<std::uint32_t>(params.integer("samples"))),
      tiles(params.text("order") == "tiles") {}

RayBatch camera_rays(const Scene& scene, const CameraOptions& options, std::uint64_t seed) {
  const Camera& camera = scene.camera(options.camera);
  const ImagePlane plane(camera, options.width, options.height);
  const IndexedRandom random(seed, 0);
  RayBatch batch;
  batch.query = Query::closest_hit;
  batch.coherent = true;
  batch.width = options.width;
  batch.height = options.height;
  const std::size_t count = std::size_t{options.width} * options.height * options.samples;
  batch.rays.reserve(count);
  batch.ray_pixels.reserve(count);
  for (const std::uint32_t pixel : pixel_order(options.width, options.height, options.tiles)) {
    const std::uint32_t column = pixel % options.width;
    const std::uint32_t row = pixel / options.width;
    for (std::uint32_t sample = 0; sample < options.samples; ++sample) {
      const std::uint64_t index = 2 * (std::uint64_t{pixel} * options.samples + sample);
      const float dx = options.samples == 1 ? 0.5F : random.uniform(index);
      const float dy = options.samples == 1 ? 0.5F : random.uniform(index + 1);
      const float x = (static_cast<float>(column) + dx) / static_cast<float>(options.width);
      const float y = (static_cast<float>(row) + dy) / static_cast<float>(options.height);
      Ray ray;
      ray.origin = camera.eye;
      ray.direction = plane.direction(x, y);
      batch.rays.push_back(ray);
      batch.ray_pixels.push_back(pixel);
    }
  }
  return batch;
}

}  // namespace raystudy::workloads
