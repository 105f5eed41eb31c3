// A bust on a pedestal bursts. Its shell is cut by planes into thousands of fragments, small near the charge and larger away from
// it; each is a rigid body of its own that flies, turns and rebounds from floor, walls and pedestal until it lies still.
// Fragments of all parts end up side by side, so that a tree of the first frame does not fit any later one.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/bust.h"
#include "scenes/procedural/key_frames.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"
#include "scenes/procedural/rigid.h"

namespace raystudy::procedural {
namespace {

constexpr int frame_count = 48;
constexpr float frame_time = 1.0F / 36;  // seconds
constexpr int substeps = 10;
constexpr float gravity = 9.81F;
constexpr float half_width = 1.5F;  // metres: of the room in x
constexpr float half_depth = 1.1F;  // and in z; a pane that is not drawn closes the front
constexpr float wall_height = 2.2F;
constexpr float bust_scale = 2.2F;
constexpr float pedestal_top = 0.4F;
constexpr float pedestal_half = 0.36F;
constexpr Vec3 charge{0, pedestal_top + 0.2F * bust_scale, 0};

enum : std::uint32_t { pale_tile, dark_tile, wall, stone, head, chest, socle };

void room(Mesh& mesh) {
  constexpr int tiles = 6;
  for (int i = 0; i < tiles; ++i) {
    for (int j = 0; j < tiles; ++j) {
      const auto x = [](int k) { return half_width * (2 * static_cast<float>(k) / tiles - 1); };
      const auto z = [](int k) { return half_depth * (2 * static_cast<float>(k) / tiles - 1); };
      mesh.material((i + j) % 2 == 0 ? pale_tile : dark_tile);
      mesh.quad({x(i), 0, z(j + 1)}, {x(i + 1), 0, z(j + 1)}, {x(i + 1), 0, z(j)}, {x(i), 0, z(j)});
    }
  }
  mesh.material(wall);
  const float w = half_width;
  const float d = half_depth;
  const float h = wall_height;
  mesh.quad({-w, 0, -d}, {w, 0, -d}, {w, h, -d}, {-w, h, -d});
  mesh.quad({-w, 0, d}, {-w, 0, -d}, {-w, h, -d}, {-w, h, d});
  mesh.quad({w, 0, -d}, {w, 0, d}, {w, h, d}, {w, h, -d});
  mesh.material(stone);
  mesh.box({}, {-pedestal_half, 0, -pedestal_half}, {pedestal_half, pedestal_top, pedestal_half});
}

/// The triangles of a surface, sorted into fragments.
class Cuts {
 public:
  Cuts(const Surface& surface, std::uint64_t seed) : seed_(seed), order_(surface.triangles.size()), centers_(order_.size()) {
    for (std::size_t t = 0; t < order_.size(); ++t) {
      const Triangle& corners = surface.triangles[t];
      order_[t] = static_cast<std::uint32_t>(t);
      centers_[t] = (surface.vertices[corners[0]] + surface.vertices[corners[1]] + surface.vertices[corners[2]]) / 3;
    }
    cut(order_, 1);
  }
  /// Calls fragment(triangles) for each.
  template <class F>
  void visit(F&& fragment) const {
    std::size_t begin = 0;
    for (const std::size_t size : sizes_) {
      fragment(std::span(order_).subspan(begin, size));
      begin += size;
    }
  }

 private:
  /// Cuts by planes across the longest side, tilted and off the middle at random, until the pieces are small enough.
  void cut(std::span<std::uint32_t> triangles, std::uint64_t node) {
    Box box;
    for (const std::uint32_t t : triangles) box.extend(centers_[t]);
    const float far = clamped(length(box.center() - charge) / (0.4F * bust_scale), 0, 1);
    const auto most = static_cast<std::size_t>(mixed(16, 80, far));
    Random random(seed_, node);
    const Vec3 extent = box.extent();
    Vec3 normal = random_direction(random) * 0.6F;
    normal[extent.x > extent.y && extent.x > extent.z ? 0 : extent.y > extent.z ? 1 : 2] += 1;
    const float place = random.uniform(0.35F, 0.65F);
    if (triangles.size() > most) {
      float low = INFINITY;
      float high = -INFINITY;
      for (const std::uint32_t t : triangles) {
        low = min(low, dot(normal, centers_[t]));
        high = max(high, dot(normal, centers_[t]));
      }
      const float plane = mixed(low, high, place);
      const auto middle = std::stable_partition(triangles.begin(), triangles.end(),
                                                [&](std::uint32_t t) { return dot(normal, centers_[t]) < plane; });
      const auto below = static_cast<std::size_t>(middle - triangles.begin());
      if (below > 0 && below < triangles.size()) {
        cut(triangles.first(below), 2 * node);
        cut(triangles.subspan(below), 2 * node + 1);
        return;
      }
    }
    sizes_.push_back(triangles.size());
  }

  std::uint64_t seed_;
  std::vector<std::uint32_t> order_;
  std::vector<Vec3> centers_;
  std::vector<std::size_t> sizes_;
};

/// A rigid body on its way: inertia as of a ball of the same spread.
class Flight {
 public:
  Flight(std::span<const Vec3> at_rest, Random random) {
    for (const Vec3 p : at_rest) center_ += p;
    center_ = center_ / static_cast<float>(at_rest.size());
    for (const Vec3 p : at_rest) {
      shape_.push_back(p - center_);
      inertia_ += dot(p - center_, p - center_);
      radius_ = max(radius_, length(p - center_));
    }
    inertia_ *= 2.0F / 3 / static_cast<float>(at_rest.size());
    const Vec3 away = center_ - charge;
    const float distance = length(away);
    release_ = distance / 8;  // the blast comes by at 8 m/s
    const float force = mixed(0.7F, 5.0F, squared(random.uniform()));
    velocity_ = normalized(away / max(distance, 1e-3F) + random_direction(random) * 0.7F) * force + Vec3{0, 1.4F, 0};
    spin_ = random_direction(random) * random.uniform(2, 25);
  }

  void step(float dt) {
    if (asleep_) return;
    release_ -= dt;
    if (release_ > 0) return;
    velocity_.y -= gravity * dt;
    center_ += velocity_ * dt;
    attitude_ = spun(attitude_, spin_, dt);
    const Contact contact = deepest();
    if (contact.depth > 0) rebound(contact);
    // What moves slowly on the floor for a tenth of a second stays there.
    const bool slow = contact.depth > 0 && dot(velocity_, velocity_) < 0.01F && dot(spin_, spin_) * inertia_ < 0.01F;
    still_ = slow ? still_ + dt : 0;
    asleep_ = still_ > 0.1F;
  }

  [[nodiscard]] Vec3 at(std::size_t vertex) const { return center_ + turned(attitude_, shape_[vertex]); }
  [[nodiscard]] bool released() const { return release_ <= 0; }

 private:
  struct Contact {
    float depth = 0;
    Vec3 arm;  // from the center to the vertex
    Vec3 normal;
  };

  [[nodiscard]] Contact deepest() const {
    const bool near_wall = std::fabs(center_.x) + radius_ > half_width || std::fabs(center_.z) + radius_ > half_depth;
    const bool near_pedestal = std::fabs(center_.x) - radius_ < pedestal_half && std::fabs(center_.z) - radius_ < pedestal_half &&
                               center_.y - radius_ < pedestal_top;
    Contact contact;
    if (center_.y > radius_ && !near_wall && !near_pedestal) return contact;
    for (const Vec3 local : shape_) {
      const Vec3 arm = turned(attitude_, local);
      const Vec3 p = center_ + arm;
      const auto meet = [&](float depth, Vec3 normal) {
        if (depth > contact.depth) contact = {depth, arm, normal};
      };
      meet(-p.y, {0, 1, 0});
      meet(std::fabs(p.x) - half_width, {p.x > 0 ? -1.0F : 1.0F, 0, 0});
      meet(std::fabs(p.z) - half_depth, {0, 0, p.z > 0 ? -1.0F : 1.0F});
      const float in_x = pedestal_half - std::fabs(p.x);
      const float in_z = pedestal_half - std::fabs(p.z);
      const float in_y = pedestal_top - p.y;
      if (in_y <= in_x && in_y <= in_z) {
        meet(in_y, {0, 1, 0});
      } else if (in_x <= in_z) {
        meet(in_x, {p.x > 0 ? 1.0F : -1.0F, 0, 0});
      } else {
        meet(in_z, {0, 0, p.z > 0 ? 1.0F : -1.0F});
      }
    }
    return contact;
  }

  /// Impulses at the contact: restitution along the normal (none at rest), Coulomb friction across it.
  void rebound(const Contact& contact) {
    constexpr float friction = 0.5F;
    center_ += contact.normal * contact.depth;
    const auto reach = [&](Vec3 direction) {
      return 1 + dot(cross(contact.arm, direction), cross(contact.arm, direction)) / inertia_;
    };
    const auto push = [&](Vec3 impulse) {
      velocity_ += impulse;
      spin_ += cross(contact.arm, impulse) / inertia_;
    };
    const Vec3 speed = velocity_ + cross(spin_, contact.arm);
    const float closing = -dot(speed, contact.normal);
    if (closing <= 0) return;
    const float restitution = closing > 0.5F ? 0.45F : 0;
    const float impulse = (1 + restitution) * closing / reach(contact.normal);
    push(contact.normal * impulse);
    const Vec3 sliding =
        velocity_ + cross(spin_, contact.arm) - contact.normal * dot(velocity_ + cross(spin_, contact.arm), contact.normal);
    const float slip = length(sliding);
    if (slip > 1e-6F) {
      const Vec3 along = sliding / slip;
      push(along * -min(friction * impulse, slip / reach(along)));
    }
  }

  std::vector<Vec3> shape_;  // relative to the center, unturned
  Vec3 center_;
  Vec3 velocity_;
  Vec3 spin_;
  Quaternion attitude_;
  float radius_ = 0;
  float inertia_ = 1e-8F;  // for unit mass
  float release_ = 0;      // seconds until the blast arrives
  float still_ = 0;
  bool asleep_ = false;
};

/// Where a fragment's vertices lie in the scene.
struct Range {
  std::size_t first;
  std::size_t count;
};

std::vector<Range> shatter(Mesh& mesh, std::size_t first, const Surface& whole, std::uint64_t seed) {
  std::vector<Range> fragments;
  std::vector<std::uint32_t> used;
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  Cuts(whole, seed).visit([&](std::span<const std::uint32_t> members) {
    used.clear();
    for (const std::uint32_t t : members) {
      const auto& corners = whole.triangles[t].vertex;
      used.insert(used.end(), corners.begin(), corners.end());
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    vertices.clear();
    for (const std::uint32_t v : used) vertices.push_back(whole.vertices[v]);
    triangles.clear();
    for (const std::uint32_t t : members) {
      Triangle& corners = triangles.emplace_back(whole.triangles[t]);
      for (std::uint32_t& v : corners.vertex) {
        v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
      }
    }
    const float height = (vertices.front().y - pedestal_top) / bust_scale;
    mesh.material(height > 0.40F ? head : height > 0.13F ? chest : socle);
    mesh.surface(vertices, triangles);
    fragments.push_back({first, vertices.size()});
    first += vertices.size();
  });
  return fragments;
}

void make_fracture(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  Mesh mesh(false);
  room(mesh);
  Surface whole = bust(triangles - mesh.triangle_count(), seed);
  for (Vec3& v : whole.vertices) v = v * bust_scale + Vec3{0, pedestal_top, 0};
  const std::vector<Range> fragments = shatter(mesh, mesh.vertex_count(), whole, seed);
  mesh.move_into(scene);
  KeyFrames frames = still_frames(scene.vertices, frame_count);
  parallel_for_indices(fragments.size(), [&](std::size_t i) {
    const auto [first, count] = fragments[i];
    const std::span<const Vec3> whole_scene = frames[0];
    Flight flight(whole_scene.subspan(first, count), Random(seed, 0xf1177 + i));
    for (std::size_t f = 1; f < frame_count; ++f) {
      for (int s = 0; s < substeps; ++s) flight.step(frame_time / substeps);
      if (!flight.released()) continue;
      for (std::size_t v = 0; v < count; ++v) frames[f][first + v] = flight.at(v);
    }
  });
  set_frames(scene, std::move(frames));
  scene.materials = {{.name = "pale-tile", .color = {0.55F, 0.54F, 0.51F}}, {.name = "dark-tile", .color = {0.30F, 0.31F, 0.33F}},
                     {.name = "wall", .color = {0.58F, 0.60F, 0.58F}},      {.name = "stone", .color = {0.36F, 0.33F, 0.30F}},
                     {.name = "head", .color = {0.72F, 0.42F, 0.24F}},      {.name = "chest", .color = {0.75F, 0.72F, 0.64F}},
                     {.name = "socle", .color = {0.16F, 0.30F, 0.48F}}};
  scene.lights = {{.name = "sun", .position = {-0.35F, 0.8F, 0.7F}, .intensity = Vec3{0.9F}, .point_at_infinity = true}};
  scene.cameras = {{.name = "room", .eye = {0.4F, 1.7F, 4.0F}, .target = {0, 1.0F, 0}, .vertical_fov = 40},
                   {.name = "floor", .eye = {-1.2F, 0.5F, 1.6F}, .target = {0.1F, 0.5F, 0}, .vertical_fov = 55}};
}

const ProceduralRegistration registration{"fracture", "animated: a bust bursts into fragments that fly apart and mix",
                                          make_fracture, frame_count};

}  // namespace
}  // namespace raystudy::procedural
