#include <array>
#include <cmath>
#include <cstdint>

#include "harness/scene/procedural.h"
#include "scenes/procedural/detail.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/ornament.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {
namespace {

enum : std::uint32_t {
  wall,
  stone,
  marble,
  pavement,
  dark_pavement,
  roof,
  wood,
  red_cloth,
  green_cloth,
  blue_cloth,
  water,
  lamp
};

constexpr float bay = 3;  // metres from column to column, and depth of the galleries
constexpr float half_wall = 0.3F;
constexpr float ground_storey = 5.4F;
constexpr float upper_storey = 4.4F;

/// What is built at all, by how many triangles there are to spend; the rest is how finely it is divided.
struct Tier {
  int bays_x;
  int bays_z;
  int storeys;
  int balusters;  ///< a bay; 0: none
  int dentils;    ///< a bay
  int tiles;      ///< of the court, a bay and direction
  bool ornament;  ///< bases, mouldings, rosettes, banners, lanterns
};
constexpr std::array<Tier, 6> tiers{{{3, 2, 1, 0, 0, 0, false},
                                     {4, 3, 2, 0, 0, 0, false},
                                     {5, 3, 2, 3, 0, 1, true},
                                     {7, 3, 2, 6, 6, 3, true},
                                     {9, 4, 2, 8, 10, 5, true},
                                     {11, 5, 2, 9, 12, 8, true}}};

class Atrium {
 public:
  Atrium(Mesh& mesh, const Tier& tier, double density, std::uint64_t seed)
      : mesh_(mesh), tier_(tier), detail_(density, seed), random_(seed, 1), stone_seed_(static_cast<std::uint32_t>(mix(seed))) {}

  void build() {
    const float hx = half_x(tier_);
    const float hz = half_z(tier_);
    // Each side has its own frame: x along the colonnade, z away from the court.
    side({{-hx, 0, hz}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, tier_.bays_x);
    side({{hx, 0, hz}, {0, 0, -1}, {0, 1, 0}, {1, 0, 0}}, tier_.bays_z);
    side({{hx, 0, -hz}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, tier_.bays_x);
    side({{-hx, 0, -hz}, {0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, tier_.bays_z);
    court(hx, hz);
    if (tier_.ornament) fountain();
  }

  static float half_x(const Tier& tier) { return static_cast<float>(tier.bays_x) * bay / 2; }
  static float half_z(const Tier& tier) { return static_cast<float>(tier.bays_z) * bay / 2; }

 private:
  void side(const Frame& frame, int bays) {
    const float length = static_cast<float>(bays) * bay;
    for (int storey = 0; storey < tier_.storeys; ++storey) {
      const float floor = storey == 0 ? 0 : ground_storey;
      const float height = storey == 0 ? ground_storey : upper_storey;
      colonnade(frame.moved({0, floor, 0}), bays, height, storey == 0);
      gallery(frame.moved({0, floor, 0}), bays, height, storey == 0);
      cornice(frame.moved({0, floor + height, 0}), length, bays);
    }
    if (tier_.storeys > 1) upper_storey_fittings(frame.moved({0, ground_storey, 0}), bays);
    roof_of(frame.moved({0, ground_storey + (tier_.storeys > 1 ? upper_storey : 0), 0}), length);
  }

  void colonnade(const Frame& frame, int bays, float height, bool ground) {
    const float radius = ground ? 0.32F : 0.24F;
    const float opening = bay / 2 - 1.35F * radius;
    const float springing = height - opening - (ground ? 0.95F : 0.7F);
    mesh_.material(stone);
    mesh_.box(frame, {-half_wall, 0, -half_wall}, {half_wall, height, half_wall});  // the corner's pier
    for (int i = 0; i < bays; ++i) {
      const Frame place = frame.moved({static_cast<float>(i) * bay, 0, 0});
      mesh_.material(ground ? stone : marble);
      if (i > 0) column(mesh_, detail_, place, {radius, springing, tier_.ornament}, stone_seed_);
      mesh_.material(wall);
      arch(mesh_, detail_, place.moved({0, springing, 0}), {bay, opening, height - springing, half_wall - 0.04F, tier_.ornament});
    }
  }

  void gallery(const Frame& frame, int bays, float height, bool ground) {
    const float length = static_cast<float>(bays) * bay;
    // The last bay is the square at the corner that two sides share.
    for (int i = 0; i <= bays; ++i) {
      const Frame place = frame.moved({static_cast<float>(i) * bay, 0, 0});
      mesh_.material(i % 2 == 0 ? pavement : dark_pavement);
      mesh_.quad(place.at({0, 0.01F, 0}), place.at({0, 0.01F, bay}), place.at({bay, 0.01F, bay}), place.at({bay, 0.01F, 0}));
      if (ground) {
        mesh_.material(wall);
        groin_vault(mesh_, detail_, place.moved({0, height - 2.2F, 0}), bay, bay, 1.7F, stone_seed_);
      }
      if (!tier_.ornament) continue;
      back_wall_bay(place.moved({0, 0, bay}), height, ground, i);
      if (!ground) {
        mesh_.material(wood);
        for (int beam = 0; beam < 3; ++beam) {
          const float x = bay * (static_cast<float>(beam) + 0.5F) / 3;
          mesh_.box(place, {x - 0.09F, height - 0.42F, 0}, {x + 0.09F, height - 0.2F, bay});
        }
      }
    }
    mesh_.material(wall);
    const float far = length + bay;
    mesh_.quad(frame.at({-bay, 0, bay}), frame.at({-bay, height, bay}), frame.at({far, height, bay}), frame.at({far, 0, bay}));
    mesh_.material(ground ? wall : wood);
    mesh_.quad(frame.at({0, height - 0.2F, 0}), frame.at({far, height - 0.2F, 0}), frame.at({far, height - 0.2F, bay}),
               frame.at({0, height - 0.2F, bay}));
  }

  /// Pilaster, and by turns a rosette or a door; a lantern before it.
  void back_wall_bay(const Frame& frame, float height, bool ground, int index) {
    mesh_.material(stone);
    mesh_.box(frame, {-0.2F, 0, -0.12F}, {0.2F, height - (ground ? 2.2F : 0.2F), 0});
    mesh_.box(frame, {-0.26F, height - (ground ? 2.4F : 0.45F), -0.2F}, {0.26F, height - (ground ? 2.2F : 0.2F), 0});
    const Frame middle = frame.moved({bay / 2, 0, 0});
    if (index % 2 == 0) {
      mesh_.material(marble);
      rosette(mesh_, detail_, middle.moved({0, height * 0.52F, 0}), 0.62F, 8 + 2 * random_.below(3));
    } else {
      mesh_.material(stone);
      mesh_.box(middle, {-0.75F, 0, -0.1F}, {-0.6F, 2.5F, 0});
      mesh_.box(middle, {0.6F, 0, -0.1F}, {0.75F, 2.5F, 0});
      mesh_.box(middle, {-0.9F, 2.5F, -0.16F}, {0.9F, 2.68F, 0});
      mesh_.material(wood);
      for (int panel = 0; panel < 4; ++panel) {
        const float x = panel % 2 == 0 ? -0.55F : 0.05F;
        const float y = panel < 2 ? 0.15F : 1.35F;
        mesh_.box(middle, {x, y, -0.05F}, {x + 0.5F, y + 1.05F, 0});
      }
    }
    if (!ground || index % 2 == 1) return;
    const Frame hung = frame.moved({bay / 2, height - 2.1F, -bay / 2});
    mesh_.material(wood);
    mesh_.box(hung, {-0.012F, 0.3F, -0.012F}, {0.012F, 1.55F, 0.012F});
    mesh_.material(lamp);
    constexpr std::array<ProfilePoint, 5> bulb{{{0.03F, 0}, {0.13F, 0.06F}, {0.16F, 0.17F}, {0.10F, 0.27F}, {0.02F, 0.31F}}};
    revolve(mesh_, detail_, hung, bulb, 10, 8);
  }

  void cornice(const Frame& frame, float length, int bays) {
    constexpr std::array<ProfilePoint, 9> profile{{{half_wall - 0.04F, -0.42F},
                                                   {half_wall, -0.40F},
                                                   {half_wall + 0.02F, -0.28F},
                                                   {half_wall + 0.12F, -0.24F},
                                                   {half_wall + 0.13F, -0.16F},
                                                   {half_wall + 0.26F, -0.13F},
                                                   {half_wall + 0.28F, -0.02F},
                                                   {half_wall + 0.22F, 0},
                                                   {0, 0.01F}}};
    mesh_.material(stone);
    moulding(mesh_, detail_, frame, half_wall, length - half_wall, profile, 2, 12);
    const int dentils = bays * tier_.dentils;
    const float step = (length - 2 * half_wall) / static_cast<float>(dentils);
    for (int i = 0; i < dentils; ++i) {
      const float x = half_wall + (static_cast<float>(i) + 0.25F) * step;
      mesh_.box(frame, {x, -0.26F, -half_wall - 0.14F}, {x + 0.5F * step, -0.15F, -half_wall + 0.02F});
    }
  }

  void upper_storey_fittings(const Frame& frame, int bays) {
    for (int i = 0; i < bays; ++i) {
      const Frame place = frame.moved({static_cast<float>(i) * bay, 0, 0});
      mesh_.material(marble);
      mesh_.box(place, {0.3F, 0.98F, -0.14F}, {bay - 0.3F, 1.1F, 0.14F});
      if (tier_.balusters > 0) mesh_.box(place, {0.3F, 0, -0.12F}, {bay - 0.3F, 0.12F, 0.12F});
      for (int k = 0; k < tier_.balusters; ++k) {
        const float x = 0.3F + (bay - 0.6F) * (static_cast<float>(k) + 0.5F) / static_cast<float>(tier_.balusters);
        baluster(mesh_, detail_, place.moved({x, 0.12F, 0}), 0.86F);
      }
      if (tier_.ornament && i % 3 == 1) {
        mesh_.material(red_cloth + static_cast<std::uint32_t>(random_.below(3)));
        const float drop = random_.uniform(2.6F, 3.3F);
        banner(mesh_, detail_, place.moved({0.55F, 0.66F, -0.84F}), bay - 1.1F, drop, random_.uniform());
        mesh_.material(wood);
        mesh_.box(place, {0.40F, 0.66F, -0.87F}, {bay - 0.40F, 0.72F, -0.81F});
        mesh_.box(place, {0.60F, 0.66F, -0.81F}, {0.66F, 0.72F, 0});
        mesh_.box(place, {bay - 0.66F, 0.66F, -0.81F}, {bay - 0.60F, 0.72F, 0});
      }
    }
  }

  void roof_of(const Frame& frame, float length) {
    mesh_.material(roof);
    const float eaves = 0.55F;
    const float far = length + bay + eaves;
    const float rows = (far - bay) * 4;
    // Half-round tiles in rows down the slope; mitred where two roofs meet.
    mesh_.grid(tier_.ornament ? detail_.cells(rows * 0.6F, 16) : 4, detail_.cells(6, 1), false, [&](float u, float v) {
      const float z = mixed(-eaves, bay + eaves, v);
      const float x = mixed(-z, length + z, u);
      const float wave = tier_.ornament ? 0.05F * std::fabs(sin_turns(x * 1.6F)) + 0.03F * (v * 12 - std::floor(v * 12)) : 0;
      return frame.at({x, 0.12F + 0.32F * (z + eaves) + wave, z});
    });
  }

  void court(float hx, float hz) {
    mesh_.material(pavement);
    const float sub = -0.05F;
    const float out = 14;
    mesh_.quad({-hx - out, sub, -hz - out}, {-hx - out, sub, hz + out}, {hx + out, sub, hz + out}, {hx + out, sub, -hz - out});
    if (tier_.tiles == 0) {
      mesh_.quad({-hx, 0, -hz}, {-hx, 0, hz}, {hx, 0, hz}, {hx, 0, -hz});
      return;
    }
    const int nx = tier_.bays_x * tier_.tiles;
    const int nz = tier_.bays_z * tier_.tiles;
    const float step = bay / static_cast<float>(tier_.tiles);
    for (int k = 0; k < nz; ++k) {
      for (int i = 0; i < nx; ++i) {
        const Vec3 corner{-hx + static_cast<float>(i) * step, sub, -hz + static_cast<float>(k) * step};
        const float rise = 0.05F + random_.uniform(-0.006F, 0.006F);
        mesh_.material((i / 2 + k / 2) % 2 == 0 ? pavement : dark_pavement);
        tile(corner, step, rise);
      }
    }
  }

  /// A slab with bevelled edges, without its underside.
  void tile(Vec3 corner, float size, float rise) {
    constexpr std::array<float, 4> place{0.004F, 0.03F, 0.97F, 0.996F};
    mesh_.grid(3, 3, false, [&](float u, float v) {
      const auto i = static_cast<std::size_t>(std::lround(u * 3));
      const auto k = static_cast<std::size_t>(std::lround(v * 3));
      const bool inside = (i == 1 || i == 2) && (k == 1 || k == 2);
      return corner + Vec3{place[i] * size, inside ? rise : rise - 0.02F, (1 - place[k]) * size};
    });
  }

  void fountain() {
    const Frame center{};
    mesh_.material(marble);
    constexpr std::array<ProfilePoint, 9> basin{{{1.75F, 0},
                                                 {1.75F, 0.12F},
                                                 {1.55F, 0.2F},
                                                 {1.5F, 0.4F},
                                                 {1.62F, 0.55F},
                                                 {1.66F, 0.62F},
                                                 {1.5F, 0.64F},
                                                 {1.38F, 0.5F},
                                                 {1.36F, 0.3F}}};
    revolve(mesh_, detail_, center, basin, 64, 24, 8, 4);
    constexpr std::array<ProfilePoint, 12> bowl{{{0.4F, 0.3F},
                                                 {0.38F, 0.5F},
                                                 {0.2F, 0.62F},
                                                 {0.17F, 0.95F},
                                                 {0.3F, 1.12F},
                                                 {0.78F, 1.32F},
                                                 {0.86F, 1.42F},
                                                 {0.8F, 1.43F},
                                                 {0.5F, 1.34F},
                                                 {0.14F, 1.32F},
                                                 {0.1F, 1.6F},
                                                 {0.02F, 1.85F}}};
    revolve(mesh_, detail_, center, bowl, 56, 40, 8, 8);
    mesh_.material(water);
    mesh_.fan(detail_.cells(16, 8), {0, 0.48F, 0}, [](float u) {
      return Vec3{1.4F * cos_turns(u), 0.48F, -1.4F * sin_turns(u)};
    });
  }

  Mesh& mesh_;
  const Tier& tier_;
  Detail detail_;
  Random random_;
  std::uint32_t stone_seed_;
};

void make_atrium(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const Tier* tier = tiers.data();
  for (const Tier& candidate : tiers) {
    Mesh least(true);
    Atrium(least, candidate, 0, seed).build();
    if (least.triangle_count() <= triangles / 2) tier = &candidate;
  }
  build_to_count(triangles, [&](Mesh& mesh, double density) { Atrium(mesh, *tier, density, seed).build(); }).move_into(scene);

  scene.materials = {
      {.name = "wall", .color = {0.56F, 0.46F, 0.33F}},
      {.name = "stone", .color = {0.52F, 0.45F, 0.36F}},
      {.name = "marble", .color = {0.66F, 0.63F, 0.58F}},
      {.name = "pavement", .color = {0.46F, 0.40F, 0.33F}},
      {.name = "dark-pavement", .color = {0.22F, 0.17F, 0.14F}},
      {.name = "roof", .color = {0.56F, 0.25F, 0.15F}},
      {.name = "wood", .color = {0.27F, 0.17F, 0.10F}},
      {.name = "red-cloth", .color = {0.58F, 0.07F, 0.07F}},
      {.name = "green-cloth", .color = {0.09F, 0.33F, 0.14F}},
      {.name = "blue-cloth", .color = {0.08F, 0.16F, 0.45F}},
      {.name = "water", .kind = MaterialKind::reflective, .color = {0.55F, 0.68F, 0.72F}},
      {.name = "lamp", .kind = MaterialKind::emitter, .color = Vec3{1}, .emission = {5, 3.6F, 2}},
  };
  const float hx = Atrium::half_x(*tier);
  const float hz = Atrium::half_z(*tier);
  scene.lights = {
      {.name = "sun", .position = {-0.42F, 0.85F, 0.36F}, .intensity = {1.35F, 1.22F, 1.0F}, .point_at_infinity = true}};
  scene.cameras = {
      {.name = "court", .eye = {-hx + 0.9F, 2.7F, hz * 0.22F}, .target = {hx * 0.6F, 3.2F, -hz * 0.25F}, .vertical_fov = 66},
      {.name = "gallery", .eye = {-hx - 0.6F, 1.9F, -hz - 1.9F}, .target = {hx * 0.5F, 2.3F, -hz + 0.2F}, .vertical_fov = 62}};
}

const ProceduralRegistration registration{"atrium", "court of colonnades, arches and vaults: big flat walls beside fine ornament",
                                          make_atrium};

}  // namespace
}  // namespace raystudy::procedural
