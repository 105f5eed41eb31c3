// A cloth that falls on a ball and drapes it down to the ground: a simulated mass-spring net.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/key_frames.h"
#include "scenes/procedural/mass_spring.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

constexpr int frame_count = 50;
constexpr float frame_time = 1.0F / 30;  // seconds
constexpr int substeps = 80;
constexpr float side = 2.4F;      // metres: of the cloth
constexpr int most_masses = 129;  // along a side: a finer cloth is a smooth surface through so many
constexpr Obstacle ball{.center = {0, 0.62F, 0}, .radius = 0.6F};

constexpr std::size_t stripes = 24;

enum : std::uint32_t { pale_tile, dark_tile, stone, warp, weft };

/// A flat cloth just above the ball, turned and off the middle by the seed, rough by a thousandth of its side.
std::vector<Vec3> flat_cloth(int n, std::uint64_t seed) {
  Random random(seed, 7);
  const float turn = random.uniform();
  const Vec3 x{cos_turns(turn), 0, sin_turns(turn)};
  const Vec3 z{-sin_turns(turn), 0, cos_turns(turn)};
  const Vec3 middle{random.uniform(-0.15F, 0.15F), ball.center.y + ball.radius + 0.12F, random.uniform(-0.15F, 0.15F)};
  std::vector<Vec3> positions;
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      const float u = static_cast<float>(column) / static_cast<float>(n - 1) - 0.5F;
      const float v = static_cast<float>(row) / static_cast<float>(n - 1) - 0.5F;
      positions.push_back(middle + x * (u * side) + z * (v * side) + Vec3{0, 0.001F * side * random.uniform(-1, 1), 0});
    }
  }
  return positions;
}

/// The surface through an n × n net (Catmull-Rom in both directions) at (u, v) in [0, 1]².
class SmoothNet {
 public:
  SmoothNet(const std::vector<Vec3>& points, int n) : points_(points), n_(n) {}

  [[nodiscard]] Vec3 at(float u, float v) const {
    const Place column = place(u);
    const Place row = place(v);
    Vec3 sum;
    for (int j = 0; j < 4; ++j) {
      const std::size_t r = static_cast<std::size_t>(std::clamp(row.first + j, 0, n_ - 1)) * static_cast<std::size_t>(n_);
      Vec3 along;
      for (int i = 0; i < 4; ++i) {
        along += points_[r + static_cast<std::size_t>(std::clamp(column.first + i, 0, n_ - 1))] * column.weight[i];
      }
      sum += along * row.weight[j];
    }
    return sum;
  }

 private:
  struct Place {
    int first;
    float weight[4];
  };
  [[nodiscard]] Place place(float t) const {
    const float x = t * static_cast<float>(n_ - 1);
    const int i = std::min(static_cast<int>(x), n_ - 2);
    const float f = x - static_cast<float>(i);
    return {
        i - 1,
        {0.5F * f * (f * (2 - f) - 1), 1 + 0.5F * f * f * (3 * f - 5), 0.5F * f * (1 + f * (4 - 3 * f)), 0.5F * f * f * (f - 1)}};
  }

  const std::vector<Vec3>& points_;
  int n_;
};

/// Between masses the smooth surface may dip below where they keep to.
Vec3 kept_off(Vec3 p) {
  constexpr float least = 0.3F * ball.thickness;
  const Vec3 out = p - ball.center;
  if (const float d = length(out); d < ball.radius + least) p = ball.center + out * ((ball.radius + least) / d);
  p.y = max(p.y, least);
  return p;
}

void surroundings(Mesh& mesh, int ball_cells) {
  constexpr int tiles = 8;
  constexpr float half = 2.4F;
  for (int i = 0; i < tiles; ++i) {
    for (int j = 0; j < tiles; ++j) {
      const auto at = [](int k) { return half * (2 * static_cast<float>(k) / tiles - 1); };
      mesh.material((i + j) % 2 == 0 ? pale_tile : dark_tile);
      mesh.quad({at(i), 0, at(j + 1)}, {at(i + 1), 0, at(j + 1)}, {at(i + 1), 0, at(j)}, {at(i), 0, at(j)});
    }
  }
  mesh.material(stone);
  mesh.ball(ball_cells, [](Vec3 d) { return ball.center + d * ball.radius; });
}

void make_cloth(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const int ball_cells = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(triangles) / 80)), 4, 60);
  Mesh around(true);
  surroundings(around, ball_cells);
  const auto cells = static_cast<double>(triangles - around.triangle_count()) / 2;
  const int nu = static_cast<int>(std::lround(std::sqrt(cells)));
  const int nv = static_cast<int>(std::lround(cells / nu));
  const int n = std::min(most_masses, nu + 1);
  MassSpringCloth cloth(flat_cloth(n, seed), n, side);

  std::vector<std::vector<Vec3>> nets{cloth.positions()};
  for (int f = 1; f < frame_count; ++f) {
    for (int s = 0; s < substeps; ++s) cloth.step(frame_time / substeps, ball);
    nets.push_back(cloth.positions());
  }
  const auto point = [&](std::size_t f, float u, float v) { return kept_off(SmoothNet(nets[f], n).at(u, v)); };
  Mesh mesh(false);
  mesh.grid(nu, nv, false, [&](float u, float v) { return point(0, u, v); });
  const auto columns = static_cast<std::size_t>(nu);
  mesh.classify([&](std::size_t t, Vec3, Vec3, Vec3) { return t / 2 % columns * stripes / columns % 2 == 0 ? warp : weft; });
  surroundings(mesh, ball_cells);
  mesh.move_into(scene);
  KeyFrames frames = still_frames(scene.vertices, frame_count);
  parallel_for_indices(frame_count, [&](std::size_t f) {
    auto out = frames[f].begin();  // the cloth comes first
    for (int j = 0; j <= nv; ++j) {
      for (int i = 0; i <= nu; ++i) {
        *out++ = point(f, static_cast<float>(i) / static_cast<float>(nu), static_cast<float>(j) / static_cast<float>(nv));
      }
    }
  });
  set_frames(scene, std::move(frames));
  scene.materials = {{.name = "pale-tile", .color = {0.55F, 0.54F, 0.51F}},
                     {.name = "dark-tile", .color = {0.32F, 0.33F, 0.35F}},
                     {.name = "stone", .color = {0.50F, 0.48F, 0.44F}},
                     {.name = "warp", .color = {0.60F, 0.10F, 0.09F}},
                     {.name = "weft", .color = {0.74F, 0.66F, 0.48F}}};
  scene.lights = {{.name = "sun", .position = {-0.5F, 0.8F, 0.45F}, .intensity = Vec3{1}, .point_at_infinity = true}};
  scene.cameras = {{.name = "ball", .eye = {1.6F, 1.9F, 3.2F}, .target = {0, 0.55F, 0}, .vertical_fov = 42},
                   {.name = "hem", .eye = {-1.4F, 0.5F, 2.0F}, .target = {0, 0.4F, 0}, .vertical_fov = 50}};
}

const ProceduralRegistration registration{"cloth", "animated: a mass-spring cloth falls on a ball", make_cloth, frame_count, 1};

}  // namespace
}  // namespace raystudy::procedural
