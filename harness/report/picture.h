#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "harness/method/method.h"
#include "harness/report/image.h"
#include "harness/scene/scene.h"

namespace raystudy {

struct RenderOptions {
  int width = 960;
  int height = 600;
  int samples = 4;       ///< a pixel; a square number, spread as a jittered grid
  int ambient_rays = 8;  ///< a sample, over the half sphere above the surface
  std::uint64_t seed = 1;
  std::function<void(double)> progress{};  ///< called now and then with the share that is done, from the calling thread
};

/// A picture of the scene for people: the scene's lights with shadows (Lambert on face normals), ambient occlusion under a bright
/// sky, a weak light at the eye that keeps closed rooms readable, mirrors and glass to a few bounces, emitters. A directional
/// light's intensity is the irradiance it gives; a point light's is the irradiance at a quarter of the scene's diagonal, so that
/// units do not matter. Linear radiance. All rays go through `session`, in batches.
[[nodiscard]] Image render_shaded(const Scene& scene, const Camera& camera, TraceSession& session, const RenderOptions& options);

/// Mean traversal steps per ray of each pixel, over every ray of every batch that belongs to the pixel; 0 where none does.
struct StepMap {
  int width = 0;
  int height = 0;
  std::vector<float> steps{};  ///< rows from the top
  double mean = 0;             ///< over all rays
};
inline constexpr const char* cannot_count_text =
    "this tracer cannot count traversal steps; expected a tracer that counts, such as 'scalar'";
/// Counts through `session` (a separate, instrumented pass). Throws Error where the tracer cannot count, std::logic_error where a
/// batch's rays do not belong to pixels or the batches' images differ in size.
[[nodiscard]] StepMap count_steps(TraceSession& session, std::span<const RayBatch> batches);

/// The steps as they are: one channel, "steps".
[[nodiscard]] Image step_image(const StepMap& map);

/// The colour of `t` in [0, 1] on the scale of heat maps: blue, cyan, green, yellow, red (Bittner 2015, Fig. 1).
[[nodiscard]] Vec3 heat_color(float t);

struct HeatMapOptions {
  float min_steps = 0;    ///< this and less is blue
  float max_steps = 100;  ///< this and more is red (Bittner 2015, Fig. 1: 100)
  bool legend = true;     ///< a labelled colour scale below the picture
  std::string quantity = "traversal steps per ray";
};
[[nodiscard]] Image heat_map(const StepMap& map, const HeatMapOptions& options);

/// The labelled colour scale alone, `width` pixels wide.
[[nodiscard]] Image heat_legend(int width, const HeatMapOptions& options);

}  // namespace raystudy
