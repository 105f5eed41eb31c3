// Hundreds of balls of uneven size that fall into a box, bounce off it and off each other and come to rest in a heap: rigid-body
// dynamics of spheres with restitution, friction and spin.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/detail.h"
#include "scenes/procedural/key_frames.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"
#include "scenes/procedural/rigid.h"

namespace raystudy::procedural {
namespace {

constexpr int frame_count = 60;
constexpr float frame_time = 1.0F / 48;  // seconds
constexpr int substeps = 12;
constexpr float gravity = 9.81F;
constexpr float half = 1;  // metres: half the box's width and depth
constexpr float wall_height = 2.2F;

enum : std::uint32_t { pale_tile, dark_tile, wall, first_ball };
constexpr std::uint32_t ball_materials = 6;

struct Ball {
  Vec3 center;
  Vec3 velocity;
  Vec3 spin;  // radians a second
  Quaternion attitude;
  float radius = 0;

  [[nodiscard]] float mass() const { return radius * radius * radius; }
  [[nodiscard]] float inertia() const { return 0.4F * mass() * radius * radius; }
};

/// Cube root by Newton's method, the same on every machine.
float cube_root(double x) {
  double root = 1;
  for (int i = 0; i < 60; ++i) root += (x / (root * root) - root) / 3;
  return static_cast<float>(root);
}

/// Balls of a twelfth of the volume of the box's cube, on a lattice above its floor that none overlaps in, thrown at random.
std::vector<Ball> thrown(int count, std::uint64_t seed) {
  const float side = cube_root(count);
  const float mean_radius = 0.27F * 2 * half / side;
  const int across = std::max(2, static_cast<int>(1.05F * side));
  const float cell = 2 * half / static_cast<float>(across);
  std::vector<Ball> balls(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    Ball& ball = balls[static_cast<std::size_t>(i)];
    ball.radius = mean_radius * random.uniform(0.6F, 1.25F);
    const float room = cell / 2 - ball.radius;
    const auto place = [&](int k) { return (static_cast<float>(k) + 0.5F) * cell + room * random.uniform(-1, 1); };
    const float x = place(i % across) - half;
    const float y = place(i / (across * across)) + 0.1F;
    const float z = place(i / across % across) - half;
    ball.center = {x, y, z};
    ball.velocity = random_direction(random) * random.uniform(1, 6) + cross(Vec3{0, 2, 0}, ball.center);
    ball.spin = random_direction(random) * 4;
    ball.attitude = random_rotation(random);
  }
  return balls;
}

/// Impulses where `a` touches `b` (nothing for a wall, which does not move) at a point along `normal`, which points to `a`.
void collide(Ball& a, Ball* b, Vec3 normal) {
  constexpr float friction = 0.25F;
  const Vec3 arm_a = normal * -a.radius;
  const Vec3 arm_b = b != nullptr ? normal * b->radius : Vec3{};
  const auto speed = [&] {
    const Vec3 of_a = a.velocity + cross(a.spin, arm_a);
    return b == nullptr ? of_a : of_a - b->velocity - cross(b->spin, arm_b);
  };
  const auto push = [&](Vec3 impulse) {
    a.velocity += impulse / a.mass();
    a.spin += cross(arm_a, impulse) / a.inertia();
    if (b == nullptr) return;
    b->velocity = b->velocity - impulse / b->mass();
    b->spin = b->spin - cross(arm_b, impulse) / b->inertia();
  };
  const float closing = -dot(speed(), normal);
  if (closing <= 0) return;
  const float inverse_mass = 1 / a.mass() + (b != nullptr ? 1 / b->mass() : 0);
  const float restitution = closing > 0.3F ? 0.92F : 0;
  const float impulse = (1 + restitution) * closing / inverse_mass;
  push(normal * impulse);
  const Vec3 at_contact = speed();
  const Vec3 sliding = at_contact - normal * dot(at_contact, normal);
  const float slip = length(sliding);
  // A ball's surface gives way 1 + 5/2 times as easily as its center.
  if (slip > 1e-6F) push(sliding * (-min(friction * impulse, slip / (3.5F * inverse_mass)) / slip));
}

class Dynamics {
 public:
  explicit Dynamics(std::vector<Ball> balls) : balls_(std::move(balls)), order_(balls_.size()) {
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<std::uint32_t>(i);
  }
  [[nodiscard]] const std::vector<Ball>& balls() const { return balls_; }

  void step(float dt) {
    for (Ball& ball : balls_) {
      ball.velocity.y -= gravity * dt;
      ball.center += ball.velocity * dt;
      ball.attitude = spun(ball.attitude, ball.spin, dt);
    }
    // Impulses once, then overlap is taken away until little of it is left.
    visit_contacts([](Ball& a, Ball* b, Vec3 normal, float) { collide(a, b, normal); });
    for (int i = 0; i < 8; ++i) {
      visit_contacts([](Ball& a, Ball* b, Vec3 normal, float depth) {
        const float share = b == nullptr ? 1 : b->mass() / (a.mass() + b->mass());
        a.center += normal * (depth * share);
        if (b != nullptr) b->center = b->center - normal * (depth * (1 - share));
      });
    }
  }

 private:
  /// Calls meet(a, b, normal, depth) for balls that overlap, then meet(a, nullptr, ...) for those beyond a wall.
  template <class F>
  void visit_contacts(F&& meet) {
    // Sweep along x; the order of the step before is nearly right, which insertion sort makes use of.
    for (std::size_t i = 1; i < order_.size(); ++i) {
      for (std::size_t k = i; k > 0 && left(order_[k]) < left(order_[k - 1]); --k) std::swap(order_[k], order_[k - 1]);
    }
    for (std::size_t i = 0; i < order_.size(); ++i) {
      Ball& a = balls_[order_[i]];
      const float right = a.center.x + a.radius;
      for (std::size_t k = i + 1; k < order_.size() && left(order_[k]) < right; ++k) {
        Ball& b = balls_[order_[k]];
        const Vec3 apart = a.center - b.center;
        const float reach = a.radius + b.radius;
        const float squared_distance = dot(apart, apart);
        if (squared_distance >= reach * reach || squared_distance == 0) continue;
        const float distance = std::sqrt(squared_distance);
        meet(a, &b, apart / distance, reach - distance);
      }
    }
    for (Ball& ball : balls_) {
      const auto wall_at = [&](float depth, Vec3 normal) {
        if (depth > 0) meet(ball, nullptr, normal, depth);
      };
      wall_at(ball.radius - ball.center.y, {0, 1, 0});
      wall_at(ball.center.x + ball.radius - half, {-1, 0, 0});
      wall_at(-ball.center.x + ball.radius - half, {1, 0, 0});
      wall_at(ball.center.z + ball.radius - half, {0, 0, -1});
      wall_at(-ball.center.z + ball.radius - half, {0, 0, 1});
    }
  }
  [[nodiscard]] float left(std::uint32_t i) const { return balls_[i].center.x - balls_[i].radius; }

  std::vector<Ball> balls_;
  std::vector<std::uint32_t> order_;  // by their left ends
};

void box(Mesh& mesh) {
  constexpr int tiles = 4;
  for (int i = 0; i < tiles; ++i) {
    for (int j = 0; j < tiles; ++j) {
      const auto at = [](int k) { return half * (2 * static_cast<float>(k) / tiles - 1); };
      mesh.material((i + j) % 2 == 0 ? pale_tile : dark_tile);
      mesh.quad({at(i), 0, at(j + 1)}, {at(i + 1), 0, at(j + 1)}, {at(i + 1), 0, at(j)}, {at(i), 0, at(j)});
    }
  }
  mesh.material(wall);
  const float h = wall_height;
  mesh.quad({-half, 0, -half}, {half, 0, -half}, {half, h, -half}, {-half, h, -half});
  mesh.quad({-half, 0, half}, {-half, 0, -half}, {-half, h, -half}, {-half, h, half});
  mesh.quad({half, 0, -half}, {half, 0, half}, {half, h, half}, {half, h, -half});
}

void make_balls(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const int count = static_cast<int>(std::clamp<std::int64_t>(triangles / 40, 24, 500));
  std::vector<std::vector<Ball>> moments{thrown(count, seed)};
  Dynamics world(moments[0]);
  for (int f = 1; f < frame_count; ++f) {
    for (int s = 0; s < substeps; ++s) world.step(frame_time / substeps);
    moments.push_back(world.balls());
  }

  std::vector<std::size_t> first;  // vertex of each ball, and the end
  build_to_count(triangles, [&](Mesh& mesh, double density) {
    Detail detail(density, seed);
    first.clear();
    box(mesh);
    for (std::size_t i = 0; i < moments[0].size(); ++i) {
      const Ball& ball = moments[0][i];
      first.push_back(mesh.vertex_count());
      mesh.material(first_ball + static_cast<std::uint32_t>(i) % ball_materials);
      mesh.ball(detail.cells(1, 1), [&](Vec3 d) { return ball.center + turned(ball.attitude, d) * ball.radius; });
    }
    first.push_back(mesh.vertex_count());
  }).move_into(scene);

  KeyFrames frames = still_frames(scene.vertices, frame_count);
  parallel_for_indices(moments[0].size(), [&](std::size_t i) {
    const Ball& start = moments[0][i];
    const Quaternion back{start.attitude.w, -start.attitude.v};
    for (std::size_t f = 1; f < frame_count; ++f) {
      const Ball& ball = moments[f][i];
      const Quaternion turn = ball.attitude * back;
      for (std::size_t v = first[i]; v < first[i + 1]; ++v) {
        frames[f][v] = ball.center + turned(turn, scene.vertices[v] - start.center);
      }
    }
  });
  set_frames(scene, std::move(frames));
  scene.materials = {{.name = "pale-tile", .color = {0.56F, 0.55F, 0.52F}}, {.name = "dark-tile", .color = {0.33F, 0.34F, 0.36F}},
                     {.name = "wall", .color = {0.56F, 0.58F, 0.60F}},      {.name = "red", .color = {0.62F, 0.12F, 0.10F}},
                     {.name = "orange", .color = {0.80F, 0.42F, 0.10F}},    {.name = "yellow", .color = {0.78F, 0.66F, 0.18F}},
                     {.name = "green", .color = {0.18F, 0.45F, 0.22F}},     {.name = "blue", .color = {0.12F, 0.27F, 0.58F}},
                     {.name = "white", .color = {0.78F, 0.78F, 0.76F}}};
  scene.lights = {{.name = "sun", .position = {-0.3F, 0.85F, 0.6F}, .intensity = Vec3{0.9F}, .point_at_infinity = true}};
  scene.cameras = {{.name = "box", .eye = {0.5F, 2.0F, 4.2F}, .target = {0, 1.1F, 0}, .vertical_fov = 42},
                   {.name = "heap", .eye = {-0.85F, 0.9F, 1.7F}, .target = {0.1F, 0.3F, 0}, .vertical_fov = 55}};
}

const ProceduralRegistration registration{"balls", "animated: hundreds of balls bounce in a box", make_balls, frame_count};

}  // namespace
}  // namespace raystudy::procedural
