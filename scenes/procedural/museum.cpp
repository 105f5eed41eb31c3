// A hall in which the triangles of a sculpture dissolve, fly through the hall as a cloud and gather into another, in which they
// are neighbours of quite different ones; that one then winds and swells. So it is in the museum of BART (Lext, Assarsson, Moller
// 2001): measured on its frames, triangles that are neighbours in the first fifth of the animation are as far apart as any two
// from the middle on, and those that are neighbours in the middle stay so to the end.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/bust.h"
#include "scenes/procedural/detail.h"
#include "scenes/procedural/key_frames.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/ornament.h"
#include "scenes/procedural/random.h"
#include "scenes/procedural/rigid.h"

namespace raystudy::procedural {
namespace {

constexpr int frame_count = 60;
constexpr float half_width = 6;  // metres
constexpr float half_depth = 5;
constexpr float height = 6;
constexpr Vec3 middle{0, 2.2F, 0};  // of the sculptures

enum : std::uint32_t { parquet, plaster, marble, plinth, art };

class Hall {
 public:
  Hall(Mesh& mesh, double density, bool complete, std::uint64_t seed)
      : mesh_(mesh), detail_(density, seed), complete_(complete), seed_(static_cast<std::uint32_t>(seed)) {}

  void build() {
    mesh_.material(parquet);
    plane(8, 8, {-half_width, 0, half_depth}, {2 * half_width, 0, 0}, {0, 0, -2 * half_depth});
    mesh_.material(plaster);
    plane(4, 4, {-half_width, 0, -half_depth}, {2 * half_width, 0, 0}, {0, height, 0});
    plane(4, 4, {-half_width, 0, half_depth}, {0, 0, -2 * half_depth}, {0, height, 0});
    plane(4, 4, {half_width, 0, -half_depth}, {0, 0, 2 * half_depth}, {0, height, 0});
    mesh_.material(marble);
    for (const float x : {-4.8F, 4.8F}) {
      for (const float z : {-4.0F, 0.0F, 4.0F}) {
        column(mesh_, detail_, {{x, 0, z}}, {.radius = 0.34F, .height = 5.2F, .complete = complete_}, seed_);
      }
    }
    mesh_.material(plinth);
    mesh_.box({}, {-0.75F, 0, -0.75F}, {0.75F, 0.9F, 0.75F});
    mesh_.box({}, {-0.95F, 0, -0.95F}, {0.95F, 0.2F, 0.95F});
  }

 private:
  void plane(double weight_u, double weight_v, Vec3 corner, Vec3 u_side, Vec3 v_side) {
    mesh_.grid(detail_.cells(weight_u, 1), detail_.cells(weight_v, 1), false,
               [&](float u, float v) { return corner + u_side * u + v_side * v; });
  }

  Mesh& mesh_;
  Detail detail_;
  bool complete_;  ///< columns with bases and capitals
  std::uint32_t seed_;
};

using Corners = std::array<Vec3, 3>;

Corners moved(const Corners& c, Vec3 by, float scale) { return {c[0] * scale + by, c[1] * scale + by, c[2] * scale + by}; }
Vec3 center_of(const Corners& c) { return (c[0] + c[1] + c[2]) / 3; }

/// The triangles of `scene`, exactly `count` of them: what is missing comes from cutting large ones in two.
std::vector<Corners> sculpture(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::size_t count) {
  std::vector<Corners> all;
  all.reserve(count);
  for (const Triangle& t : triangles) all.push_back({vertices[t[0]], vertices[t[1]], vertices[t[2]]});
  all.resize(std::min(all.size(), count));
  std::vector<std::pair<float, std::uint32_t>> by_size(all.size());
  for (std::size_t t = 0; t < all.size(); ++t) {
    const Vec3 n = cross(all[t][1] - all[t][0], all[t][2] - all[t][0]);
    by_size[t] = {-dot(n, n), static_cast<std::uint32_t>(t)};
  }
  std::sort(by_size.begin(), by_size.end());
  for (std::size_t i = 0; all.size() < count; ++i) {
    Corners& c = all[by_size[i].second];
    std::size_t longest = 0;
    const auto side = [&](std::size_t k) { return length(c[(k + 1) % 3] - c[k]); };
    for (std::size_t k = 1; k < 3; ++k) {
      if (side(k) > side(longest)) longest = k;
    }
    const Vec3 cut = (c[longest] + c[(longest + 1) % 3]) / 2;
    Corners other = c;
    other[longest] = cut;
    c[(longest + 1) % 3] = cut;
    all.push_back(other);
  }
  return all;
}

std::vector<Corners> shuffled(std::vector<Corners> all, Random random) {
  for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random.bits() % i]);
  return all;
}

std::vector<Corners> bust_sculpture(std::size_t count, std::uint64_t seed) {
  const Surface surface = bust(static_cast<std::int64_t>(static_cast<double>(count) * 0.96), seed);
  std::vector<Corners> all = sculpture(surface.vertices, surface.triangles, count);
  for (Corners& c : all) c = moved(c, {0, 0.9F, 0}, 3.6F);
  return all;
}

Scene scene_of(Mesh& mesh) {
  Scene scene;
  mesh.move_into(scene);
  return scene;
}

/// A tube along a torus knot: twice around the axis, three times through the hole.
std::vector<Corners> knot_sculpture(std::size_t count) {
  const auto around = std::max(3, static_cast<int>(std::sqrt(static_cast<double>(count) / 2 / 12)));
  const int along = static_cast<int>(count) / 2 / around;
  const auto path = [](double t) {
    const float r = 0.82F + 0.36F * cos_turns(3 * t);
    return middle + Vec3{r * cos_turns(2 * t), r * sin_turns(2 * t), 0.42F * sin_turns(3 * t)};
  };
  Mesh mesh(false);
  mesh.grid(around, along, true, [&](float u, float v) {
    const Vec3 at = path(v);
    const Vec3 forward = normalized(path(v + 1e-3) - path(v - 1e-3));
    const Vec3 side = normalized(cross(forward, at - middle));
    const Vec3 up = cross(side, forward);
    return at + (side * cos_turns(u) + up * sin_turns(u)) * 0.2F;
  });
  const Scene scene = scene_of(mesh);
  return sculpture(scene.vertices, scene.triangles, count);
}

/// The knot as it winds about the vertical through its middle and swells where it is low; `share` from 0, as it was, to 1.
Vec3 wound(Vec3 p, float share) {
  const Vec3 d = p - middle;
  const double turn = 0.35 * static_cast<double>(share * d.y);
  const float swell = 1 + 0.45F * share * smooth_step(0.6F, -1.2F, d.y);
  const Vec3 q{d.x * cos_turns(turn) + d.z * sin_turns(turn), d.y * (1 - 0.2F * share),
               d.z * cos_turns(turn) - d.x * sin_turns(turn)};
  return middle + Vec3{q.x * swell, q.y, q.z * swell};
}

/// A triangle's place and turn, and its corners in the plane x, y of that frame, the first side along x.
struct Posed {
  explicit Posed(const Corners& c) : center(center_of(c)) {
    const Vec3 x = normalized(c[1] - c[0]);
    const Vec3 z = normalized(cross(x, c[2] - c[0]));
    const Vec3 y = cross(z, x);
    attitude = rotation_to(x, y, z);
    for (std::size_t i = 0; i < 3; ++i) corner[i] = {dot(c[i] - center, x), dot(c[i] - center, y), 0};
  }
  Vec3 center;
  Quaternion attitude;
  Corners corner;
};

/// One triangle's way from one sculpture to the other, tumbling. The first bursts from the top down, away from its middle and
/// towards where each triangle is wanted, so that those that fly together for a while have their start or their end in common.
class Way {
 public:
  Way(const Corners& from, const Corners& to, Random random)
      : from_(from),
        to_(to),
        delay_(0.36F * smooth_step(2.5F, 0.9F, from_.center.y) + 0.04F * random.uniform()),
        tumble_(random_rotation(random)) {
    // The curve comes half as near as this point lies, which keeps it in the hall.
    const auto within = [](float x, float half) { return std::clamp(x, -1.8F * half, 1.8F * half); };
    const Vec3 aim = middle + (from_.center - middle) * 6 + (to_.center - middle) * 3.5F;
    const auto jitter = [&random] { return random.uniform(-0.3F, 0.3F); };
    const float x = within(aim.x + jitter(), half_width - 0.5F);
    const float z = within(aim.z + jitter(), half_depth - 0.5F);
    bend_ = Vec3{x, std::clamp(aim.y + jitter(), -0.5F, 2 * height - 3.4F), z};
  }

  /// At a phase in (0, 1).
  [[nodiscard]] Corners at(float phase) const {
    const float t = smooth_step(delay_, delay_ + 0.6F, phase);
    const Vec3 center = mixed(mixed(from_.center, bend_, t), mixed(bend_, to_.center, t), t);
    const Quaternion attitude = blended(blended(from_.attitude, tumble_, t), blended(tumble_, to_.attitude, t), t);
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = center + turned(attitude, mixed(from_.corner[i], to_.corner[i], t));
    return corners;
  }

 private:
  Posed from_;
  Posed to_;
  float delay_;
  Vec3 bend_;
  Quaternion tumble_;
};

constexpr int first_flying = 12;  // frames
constexpr int first_gathered = 30;

void make_museum(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(triangles < 5'000 ? triangles * 7 / 10 : triangles * 85 / 100);
  const std::vector<Corners> bust = shuffled(bust_sculpture(count, seed), Random(seed, 0x51));
  const std::vector<Corners> knot = shuffled(knot_sculpture(count), Random(seed, 0x52));
  Mesh mesh = build_to_count(triangles - static_cast<std::int64_t>(count),
                             [&](Mesh& m, double density) { Hall(m, density, triangles >= 5'000, seed).build(); });
  const std::size_t first = mesh.vertex_count();
  mesh.reserve(first + 3 * count, static_cast<std::size_t>(mesh.triangle_count()) + count);
  mesh.material(art);
  for (const Corners& c : bust) mesh.triangle(c[0], c[1], c[2]);
  mesh.move_into(scene);
  KeyFrames frames = still_frames(scene.vertices, frame_count);
  parallel_for_indices(count, [&](std::size_t t) {
    const Way way(bust[t], knot[t], Random(seed, t));
    for (int f = 0; f < frame_count; ++f) {
      Corners corners = bust[t];
      if (f >= first_gathered) {
        const float share = static_cast<float>(f - first_gathered) / (frame_count - 1 - first_gathered);
        for (std::size_t i = 0; i < 3; ++i) corners[i] = wound(knot[t][i], smooth_step(0, 1, share));
      } else if (f >= first_flying) {
        corners = way.at(static_cast<float>(f - first_flying + 1) / (first_gathered - first_flying + 1));
      }
      std::copy(corners.begin(), corners.end(), &frames[static_cast<std::size_t>(f)][first + 3 * t]);
    }
  });
  set_frames(scene, std::move(frames));
  scene.materials = {{.name = "parquet", .color = {0.36F, 0.24F, 0.14F}},
                     {.name = "plaster", .color = {0.62F, 0.58F, 0.50F}},
                     {.name = "marble", .color = {0.70F, 0.69F, 0.66F}},
                     {.name = "plinth", .color = {0.30F, 0.30F, 0.32F}},
                     {.name = "art", .color = {0.74F, 0.55F, 0.20F}}};
  scene.lights = {{.name = "sun", .position = {0.4F, 0.75F, 0.6F}, .intensity = Vec3{1}, .point_at_infinity = true}};
  scene.cameras = {{.name = "hall", .eye = {1.6F, 3.0F, 8.6F}, .target = {0, 2.3F, 0}, .vertical_fov = 44},
                   {.name = "plinth", .eye = {-2.6F, 1.7F, 4.2F}, .target = {0, 2.1F, 0}, .vertical_fov = 48}};
}

const ProceduralRegistration registration{
    "museum", "animated: the triangles of a sculpture dissolve and gather into another, in another order", make_museum,
    frame_count};

}  // namespace
}  // namespace raystudy::procedural
