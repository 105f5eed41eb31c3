#include <cstddef>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

/// Triangles spread evenly in the unit cube and turned evenly, few large and many small: the longest arm of each is drawn so that
/// areas span two orders of magnitude. Sizes go with N^(-1/3), so that a ray meets as many at every count.
void make_soup(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(triangles);
  // Cube root by Newton's method: the C library's is not the same to the bit everywhere.
  double root = 1;
  for (int i = 0; i < 60; ++i) root += (static_cast<double>(triangles) / (root * root) - root) / 3;
  const auto size = static_cast<float>(1.6 / root);

  std::vector<Vec3> vertices(3 * count);
  std::vector<Triangle> indices(count);
  std::vector<std::uint32_t> materials(count);
  parallel_for_indices(count, [&](std::size_t t) {
    Random random(seed, t);
    const Vec3 center{random.uniform(), random.uniform(), random.uniform()};
    const float arm = size * (0.15F + 0.85F * squared(squared(random.uniform())));
    for (std::size_t i = 0; i < 3; ++i) {
      vertices[3 * t + i] = center + random_direction(random) * (arm * random.uniform(0.5F, 1));
      indices[t].vertex[i] = static_cast<std::uint32_t>(3 * t + i);
    }
    materials[t] = static_cast<std::uint32_t>(random.below(6));
  });
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(indices));
  scene.triangle_materials = SharedArray<std::uint32_t>(std::move(materials));
  scene.materials = {{.name = "red", .color = {0.70F, 0.16F, 0.12F}},    {.name = "orange", .color = {0.80F, 0.42F, 0.10F}},
                     {.name = "yellow", .color = {0.78F, 0.68F, 0.20F}}, {.name = "green", .color = {0.22F, 0.52F, 0.24F}},
                     {.name = "blue", .color = {0.14F, 0.30F, 0.62F}},   {.name = "white", .color = {0.80F, 0.80F, 0.78F}}};
  scene.lights = {{.name = "sun", .position = {0.45F, 0.8F, 0.6F}, .intensity = Vec3{1}, .point_at_infinity = true}};
  scene.cameras = {{.name = "outside", .eye = {1.65F, 1.35F, 2.05F}, .target = {0.5F, 0.47F, 0.5F}, .vertical_fov = 42},
                   {.name = "inside", .eye = {0.5F, 0.5F, 0.98F}, .target = {0.45F, 0.45F, 0}, .vertical_fov = 70}};
}

const ProceduralRegistration registration{"soup", "random triangles of uneven size, evenly spread in a cube", make_soup};

}  // namespace
}  // namespace raystudy::procedural
