#include <cmath>
#include <vector>

#include "harness/scene/procedural.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/noise.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

constexpr float side = 4000;       // metres
constexpr float water_level = 90;  // metres above the lowest valley

/// Height in metres at (x, z) in [0, side]². Mountains are a ridged multifractal (Musgrave, in Ebert et al., Texturing and
/// Modeling, 3rd ed., ch. 16); everywhere finer octaves fade where the coarser ones are steep, which leaves the sharp ridges and
/// smooth valley floors that water carves.
class Height {
 public:
  Height(std::uint64_t seed, int octaves) : seed_(static_cast<std::uint32_t>(mix(seed))), octaves_(octaves) {}

  float operator()(float x, float z) const {
    double px = x * (1.0 / 1150);
    double pz = z * (1.0 / 1150);
    // Bends the ranges, and says where they stand.
    const float bend_x = gradient_noise(px * 1.3 + 17, pz * 1.3 - 5, seed_ ^ 0x51U).value;
    const float bend_z = gradient_noise(px * 1.3 - 8, pz * 1.3 + 23, seed_ ^ 0x52U).value;
    px += 0.28 * bend_x;
    pz += 0.28 * bend_z;
    const float range = smooth_step(-0.34F, 0.26F, gradient_noise(px * 0.50 - 3, pz * 0.50 + 9, seed_ ^ 0xa3U).value);
    float sum = 0;
    float amplitude = 1;
    float slope_x = 0;
    float slope_z = 0;
    float weight = 1;
    for (int octave = 0; octave < octaves_; ++octave) {
      const Noise2 n = gradient_noise(px, pz, seed_ + static_cast<std::uint32_t>(octave));
      slope_x += n.dx * 0.6F;
      slope_z += n.dy * 0.6F;
      const float eroded = 1 / (1 + slope_x * slope_x + slope_z * slope_z);
      const float ridge = squared(1 - min(1, std::fabs(n.value) * 1.9F)) * weight;
      sum += amplitude * (mixed(0.34F + 0.85F * n.value, 0.9F * ridge, range) * mixed(1, eroded, 0.7F));
      weight = clamped(ridge * 1.5F, 0.2F, 1);
      amplitude *= 0.5F;
      // Turning each octave by the angle of the triangle 3, 4, 5 hides the lattice.
      const double turned = 1.6 * px + 1.2 * pz + 0.31;
      pz = 1.6 * pz - 1.2 * px + 0.17;
      px = turned;
      const float turned_slope = 0.8F * slope_x + 0.6F * slope_z;
      slope_z = 0.8F * slope_z - 0.6F * slope_x;
      slope_x = turned_slope;
    }
    return sum * (120 + 520 * range);
  }

 private:
  std::uint32_t seed_;
  int octaves_;
};

enum : std::uint32_t { grass, rock, snow, sand, water };

std::uint32_t ground(Vec3 a, Vec3 b, Vec3 c, float dither) {
  const Vec3 normal = cross(b - a, c - a);
  const float up = std::fabs(normal.y) / length(normal);
  const float height = (a.y + b.y + c.y) * (1.0F / 3) + dither;
  if (height < water_level + 6) return sand;
  if (height > 400 && up > 0.66F) return snow;
  return up < 0.80F || height > 370 ? rock : grass;
}

void make_terrain(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const auto wanted = static_cast<double>(triangles - 2);
  const auto nu = static_cast<int>(std::lround(std::sqrt(wanted / 2)));
  const auto nv = static_cast<int>(std::lround(wanted / 2 / nu));
  int octaves = 5;  // the finest octave's wavelength is near two triangles
  while (octaves < 16 && 1150.0 / static_cast<double>(1 << octaves) > side / nu) ++octaves;
  const Height height(seed, octaves);

  Mesh mesh(false);
  {
    Mesh counted(true);
    counted.grid(nu, nv, false, [](float, float) { return Vec3{}; });
    counted.quad({}, {}, {}, {});
    mesh = Mesh::sized_as(counted);
  }
  mesh.grid(nu, nv, false, [&](float u, float v) {
    const float x = u * side;
    const float z = (1 - v) * side;
    return Vec3{x, height(x, z), z};
  });
  mesh.classify([seed](std::size_t t, Vec3 a, Vec3 b, Vec3 c) { return ground(a, b, c, 16 * Random(seed, t).uniform() - 8); });
  mesh.material(water);
  mesh.quad({0, water_level, side}, {side, water_level, side}, {side, water_level, 0}, {0, water_level, 0});
  mesh.move_into(scene);

  scene.materials = {{.name = "grass", .color = {0.15F, 0.19F, 0.07F}},
                     {.name = "rock", .color = {0.36F, 0.32F, 0.28F}},
                     {.name = "snow", .color = {0.86F, 0.88F, 0.92F}},
                     {.name = "sand", .color = {0.52F, 0.44F, 0.30F}},
                     {.name = "water", .kind = MaterialKind::reflective, .color = {0.45F, 0.58F, 0.66F}}};
  scene.lights = {{.name = "sun", .position = {0.75F, 0.5F, 0.25F}, .intensity = Vec3{1}, .point_at_infinity = true}};
  const float mid = height(side * 0.45F, side * 0.98F);
  scene.cameras = {
      {.name = "bird", .eye = {side * 0.40F, 1500, side * 1.16F}, .target = {side * 0.52F, 80, side * 0.46F}, .vertical_fov = 46},
      {.name = "valley",

       .eye = {side * 0.45F, max(mid, water_level) + 90, side * 0.98F},
       .target = {side * 0.48F, max(mid, water_level) + 20, 0},
       .vertical_fov = 50}};
}

const ProceduralRegistration registration{"terrain", "fractal heightmap of ridges, valleys and a lake", make_terrain};

}  // namespace
}  // namespace raystudy::procedural
