#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "harness/scene/procedural.h"
#include "scenes/procedural/detail.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/noise.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/ornament.h"
#include "scenes/procedural/random.h"
#include "scenes/procedural/stands.h"

namespace raystudy::procedural {
namespace {

enum : std::uint32_t { porcelain = stands_material_count, table };

constexpr float table_top = 0.74F;

/// The teapot: 22 cm high, lobed, with a band of leaves in relief, spout, handle and lid.
class Teapot {
 public:
  Teapot(Mesh& mesh, double density, std::uint64_t seed)
      : mesh_(mesh), detail_(density, seed), seed_(static_cast<std::uint32_t>(mix(seed))) {}

  void build() {
    mesh_.material(table);
    constexpr std::array<ProfilePoint, 12> stand{{{0.02F, 0.0F},
                                                  {0.23F, 0.003F},
                                                  {0.24F, 0.02F},
                                                  {0.10F, 0.05F},
                                                  {0.035F, 0.12F},
                                                  {0.03F, 0.40F},
                                                  {0.035F, 0.60F},
                                                  {0.10F, 0.69F},
                                                  {0.31F, 0.705F},
                                                  {0.325F, 0.72F},
                                                  {0.315F, table_top},
                                                  {0.02F, table_top}}};
    revolve(mesh_, detail_, {}, stand, 24, 10, 8, 6);
    mesh_.material(porcelain);
    body();
    lid();
    tube(
        24, 56, 14,
        [](float t) {
          return curve({0.078F, 0.060F}, {0.150F, 0.052F}, {0.118F, 0.150F}, {0.186F, 0.168F}, t);
        },
        [](float t) { return mixed(0.030F, 0.0115F, 1 - squared(1 - t)); }, 0.010F);
    tube(
        18, 48, 12, [](float t) { return handle(t); }, [](float t) { return 0.0095F + 0.004F * squared(2 * t - 1); }, 0.004F);
  }

 private:
  using Planar = std::pair<float, float>;  // x, y in the plane of spout and handle

  static Planar curve(Planar a, Planar b, Planar c, Planar d, float t) {
    const float s = 1 - t;
    const float ka = s * s * s;
    const float kb = 3 * s * s * t;
    const float kc = 3 * s * t * t;
    const float kd = t * t * t;
    return {ka * a.first + kb * b.first + kc * c.first + kd * d.first,
            ka * a.second + kb * b.second + kc * c.second + kd * d.second};
  }
  static Planar handle(float t) {
    if (t < 0.5F) return curve({-0.078F, 0.150F}, {-0.120F, 0.178F}, {-0.178F, 0.160F}, {-0.170F, 0.108F}, 2 * t);
    return curve({-0.170F, 0.108F}, {-0.162F, 0.066F}, {-0.130F, 0.052F}, {-0.088F, 0.044F}, 2 * t - 1);
  }

  /// Relief on the glaze, in metres, at `u` around and `v` up the body.
  [[nodiscard]] float relief(float u, float v, Vec3 p) const {
    const float lobe = std::fabs(sin_turns(u * 8));
    const float lobed = smooth_step(0.06F, 0.18F, v) * (1 - smooth_step(0.52F, 0.62F, v));
    float out = 0.0035F * lobed * (lobe - 0.5F);
    const float y = (v - 0.66F) / 0.2F;
    if (y > 0 && y < 1) {
      const float x = u * 20 + 0.5F * sin_turns(0.5F * y);
      const float across = (2 * (x - std::floor(x)) - 1) / max(0.1F, sin_turns(0.5F * y));
      if (across * across < 1) out += 0.0026F * (1 - across * across) * (1 - 0.5F * bump(squared(4 * across)));
    }
    return out + 0.0006F * fractal_noise(p * 60.0F, 4, seed_);
  }

  void body() {
    constexpr std::array<ProfilePoint, 13> profile{{{0.012F, 0.002F},
                                                    {0.052F, 0},
                                                    {0.060F, 0.004F},
                                                    {0.056F, 0.012F},
                                                    {0.078F, 0.026F},
                                                    {0.098F, 0.055F},
                                                    {0.106F, 0.088F},
                                                    {0.102F, 0.118F},
                                                    {0.088F, 0.146F},
                                                    {0.068F, 0.164F},
                                                    {0.064F, 0.170F},
                                                    {0.070F, 0.176F},
                                                    {0.062F, 0.177F}}};
    const int nu = detail_.cells(96, 10);
    mesh_.grid(nu, detail_.cells(60, 6), true, [&](float u, float v) {
      const ProfilePoint p = on_profile(profile, v);
      const Vec3 on{p.radius * cos_turns(-u), table_top + p.height, p.radius * sin_turns(-u)};
      return on + Vec3{cos_turns(-u), 0, sin_turns(-u)} * relief(u, v, on);
    });
  }

  void lid() {
    constexpr std::array<ProfilePoint, 13> profile{{{0.066F, 0.172F},
                                                    {0.067F, 0.178F},
                                                    {0.060F, 0.185F},
                                                    {0.044F, 0.194F},
                                                    {0.022F, 0.200F},
                                                    {0.009F, 0.203F},
                                                    {0.0075F, 0.208F},
                                                    {0.015F, 0.214F},
                                                    {0.0185F, 0.221F},
                                                    {0.016F, 0.228F},
                                                    {0.010F, 0.232F},
                                                    {0.004F, 0.234F},
                                                    {0.0008F, 0.2345F}}};
    const Frame frame{{0, table_top, 0}};
    const int nu = detail_.cells(64, 8);
    mesh_.grid(nu, detail_.cells(40, 6), true, [&](float u, float v) {
      const ProfilePoint p = on_profile(profile, v);
      const float lobed =
          0.0016F * smooth_step(0.14F, 0.2F, v) * (1 - smooth_step(0.28F, 0.38F, v)) * (std::fabs(sin_turns(u * 8)) - 0.5F);
      const float r = p.radius + lobed;
      return frame.at({r * cos_turns(-u), p.height + lobed, r * sin_turns(-u)});
    });
  }

  /// A tube along a curve in the plane z = 0, with rings in relief.
  template <class Path, class Radius>
  void tube(double weight_around, double weight_along, int rings, Path&& path, Radius&& radius, float depth) {
    mesh_.grid(detail_.cells(weight_around, 6), detail_.cells(weight_along, 5), true, [&](float u, float v) {
      const auto [x, y] = path(v);
      const auto [ax, ay] = path(max(0, v - 0.004F));
      const auto [bx, by] = path(min(1, v + 0.004F));
      const float norm = std::sqrt(squared(bx - ax) + squared(by - ay));
      const Vec3 normal{(ay - by) / norm, (bx - ax) / norm, 0};
      const float ring =
          1 + depth * 8 * bump(squared(2 * (v * static_cast<float>(rings) - std::floor(v * static_cast<float>(rings))) - 1));
      const float r = radius(v) * ring;
      const Vec3 at = Vec3{x, y + table_top, 0} + normal * (r * cos_turns(u)) + Vec3{0, 0, r * sin_turns(u)};
      return at + (normal * cos_turns(u) + Vec3{0, 0, sin_turns(u)}) * (0.0004F * fractal_noise(at * 60.0F, 4, seed_));
    });
  }

  Mesh& mesh_;
  Detail detail_;
  std::uint32_t seed_;
};

void make_stadium(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  // The stands take a fifth of a small scene and never more than some ten thousand triangles of a large one.
  const double share = min(1, static_cast<float>(std::sqrt(static_cast<double>(triangles) / 1e6)));
  const int around = std::max(12, static_cast<int>(144 * share) / 4 * 4);
  const int rows = std::max(2, static_cast<int>(30 * share));
  const int masts = triangles < 5'000 ? 0 : 4;
  build_to_count(triangles, [&](Mesh& mesh, double density) {
    stands(mesh, around, rows, masts);
    Teapot(mesh, density, seed).build();
  }).move_into(scene);
  scene.materials = stands_materials();
  scene.materials.push_back({.name = "porcelain", .color = {0.62F, 0.70F, 0.80F}});
  scene.materials.push_back({.name = "table", .color = {0.40F, 0.24F, 0.12F}});
  scene.lights = {
      {.name = "sun", .position = {0.55F, 0.65F, 0.50F}, .intensity = {1.1F, 1.05F, 0.95F}, .point_at_infinity = true}};
  scene.cameras = {{.name = "stands", .eye = {-88, 27, 52}, .target = {6, 3, -4}, .vertical_fov = 62},
                   {.name = "teapot", .eye = {0.18F, 0.98F, 0.62F}, .target = {0.005F, 0.835F, 0}, .vertical_fov = 34}};
}

const ProceduralRegistration registration{"stadium", "teapot in a stadium: a small detailed object in a huge sparse ground",
                                          make_stadium};

}  // namespace
}  // namespace raystudy::procedural
