// Articulated figures that sprint along the track of a large stadium: small, fast and deforming things in a big static scene.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"
#include "scenes/procedural/detail.h"
#include "scenes/procedural/key_frames.h"
#include "scenes/procedural/mesh.h"
#include "scenes/procedural/numeric.h"
#include "scenes/procedural/random.h"
#include "scenes/procedural/stands.h"

namespace raystudy::procedural {
namespace {

constexpr int frame_count = 60;
constexpr float frame_time = 0.06F;  // seconds
constexpr int part_count = 13;

enum : std::uint32_t { skin = stands_material_count, first_shirt };
constexpr std::uint32_t shirts = 4;

/// A body part: an ellipsoid with these half axes.
using Pose = std::array<Frame, part_count>;

/// Along x in front of the plane x, y: `turns` from straight down, forwards.
Vec3 limb(float turns) { return {sin_turns(turns), -cos_turns(turns), 0}; }

/// An ellipsoid from joint to joint, a little longer than the bone, and `thick` to the sides.
Frame bone(Vec3 from, Vec3 to, float thick, float deep) {
  const Vec3 along = to - from;
  const Vec3 y = normalized(along);
  const Vec3 z{0, 0, 1};
  return {(from + to) / 2, cross(y, z) * deep, along * 0.5F + y * (0.4F * thick), z * thick};
}

/// A sprinter of 1.8 m in its own frame (x forwards, y up), `stride` in turns of the whole cycle of two steps.
Pose sprinter(float stride) {
  constexpr float thigh = 0.44F;
  constexpr float shank = 0.43F;
  constexpr float foot = 0.20F;
  struct Leg {
    Vec3 knee, ankle, toe;
  };
  const auto leg = [&](float phase) {
    const float hip = 0.05F + 0.14F * sin_turns(phase);
    const float lift = smooth_step(-0.3F, 1, cos_turns(phase));  // the knee bends while the thigh swings forwards
    const float below = hip - 0.03F - 0.24F * lift;
    const Vec3 knee = limb(hip) * thigh;
    const Vec3 ankle = knee + limb(below) * shank;
    return Leg{knee, ankle, ankle + limb(below + 0.25F - 0.06F * (1 - lift)) * foot};
  };
  const Leg left = leg(stride);
  const Leg right = leg(stride + 0.5F);
  // The lower foot carries: it stands on the ground.
  const float lowest = min(min(left.ankle.y, left.toe.y), min(right.ankle.y, right.toe.y));
  const Vec3 hip{0, 0.04F - lowest, 0};
  const Vec3 up = normalized(Vec3{0.16F, 1, 0});
  const Vec3 neck = hip + up * 0.55F;
  Pose pose;
  std::size_t n = 0;
  pose[n++] = bone(hip - up * 0.06F, hip + up * 0.12F, 0.15F, 0.11F);
  pose[n++] = bone(hip + up * 0.12F, neck, 0.19F, 0.12F);
  pose[n++] = bone(neck + up * 0.04F, neck + up * 0.27F, 0.085F, 0.10F);
  for (const float side : {-1.0F, 1.0F}) {
    const Leg& l = side < 0 ? left : right;
    const Vec3 joint = hip + Vec3{0, 0, 0.1F * side};
    pose[n++] = bone(joint, joint + l.knee, 0.085F, 0.095F);
    pose[n++] = bone(joint + l.knee, joint + l.ankle, 0.055F, 0.06F);
    pose[n++] = bone(joint + l.ankle - (l.toe - l.ankle) * 0.15F, joint + l.toe, 0.045F, 0.035F);
    // Arms swing against the legs.
    const float swing = -0.12F * sin_turns(side < 0 ? stride : stride + 0.5F) - 0.02F;
    const Vec3 shoulder = hip + up * 0.48F + Vec3{0, 0, 0.23F * side};
    const Vec3 elbow = shoulder + limb(swing) * 0.31F;
    pose[n++] = bone(shoulder, elbow, 0.05F, 0.055F);
    pose[n++] = bone(elbow, elbow + limb(swing + 0.24F) * 0.30F + Vec3{0, 0, -0.05F * side}, 0.04F, 0.045F);
  }
  return pose;
}

struct Runner {
  float start;   // turns around the stadium
  float lane;    // metres from the track's inner edge
  float speed;   // metres a second
  float height;  // of 1.8 m
  float phase;   // turns of the stride at the start
};

std::vector<Runner> field_of(int count, std::uint64_t seed) {
  std::vector<Runner> all;
  for (int i = 0; i < count; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    const int row = i / 8;
    const float start = 0.300F - 0.0045F * static_cast<float>(row) - 0.003F * random.uniform();
    const float lane = 0.6F + 0.95F * static_cast<float>(i % 8);
    all.push_back({start, lane, random.uniform(5.5F, 8), random.uniform(0.9F, 1.08F), random.uniform()});
  }
  return all;
}

/// The runner's frame at every key frame, moved along the track by small steps, and the strides it has made.
struct Station {
  Frame frame;
  float stride;
};
std::vector<Station> run(const Runner& runner) {
  constexpr int substeps = 16;
  std::vector<Station> stations;
  float turns = runner.start;
  float distance = 0;
  for (int f = 0; f < frame_count; ++f) {
    const auto ahead = [&](float t) { return oval(turns + t, runner.lane, 0); };
    const Vec3 x = normalized(ahead(-1e-3F) - ahead(1e-3F));
    const float h = runner.height;
    const float stride = runner.phase + distance / (3.6F * h);
    stations.push_back({{ahead(0), x * h, Vec3{0, h, 0}, cross(x, {0, 1, 0}) * h}, stride - std::floor(stride)});
    for (int s = 0; s < substeps; ++s) {
      const float way = runner.speed * frame_time / substeps;
      turns -= way * 2e-3F / length(ahead(-1e-3F) - ahead(1e-3F));
      distance += way;
    }
  }
  return stations;
}

/// `part` of a body that stands in `body`.
Frame placed(const Frame& body, const Frame& part) {
  const auto direction = [&](Vec3 d) { return body.at(d) - body.origin; };
  return {body.at(part.origin), direction(part.x), direction(part.y), direction(part.z)};
}

void make_runners(Scene& scene, std::int64_t triangles, std::uint64_t seed) {
  const int count = static_cast<int>(std::clamp<std::int64_t>(triangles / 800, 3, 32));
  const std::vector<Runner> runners = field_of(count, seed);
  // The stands take about half: 4 triangles a section and row, and as many sections as make these square.
  const int around = std::max(12, static_cast<int>(std::sqrt(0.45 * static_cast<double>(triangles)) - 8) / 4 * 4);
  const int rows = std::max(2, around / 4);
  std::vector<std::size_t> first;  // vertex of each part of each runner, and the end
  std::vector<Vec3> directions;    // of their vertices from the part's center, in its own frame
  build_to_count(triangles, [&](Mesh& mesh, double density) {
    Detail detail(density, seed);
    stands(mesh, around, rows, triangles < 5'000 ? 0 : 4);
    first.clear();
    for (int r = 0; r < count; ++r) {
      for (int part = 0; part < part_count; ++part) {
        const bool dressed = part == 0 || part == 1 || part == 3 || part == 8;
        mesh.material(dressed ? first_shirt + static_cast<std::uint32_t>(r) % shirts : static_cast<std::uint32_t>(skin));
        first.push_back(mesh.vertex_count());
        mesh.ball(detail.cells(part < 3 ? 1.5 : 1, 1), [&](Vec3 d) {
          directions.push_back(d);
          return d;
        });
      }
    }
    first.push_back(mesh.vertex_count());
  }).move_into(scene);

  KeyFrames frames = still_frames(scene.vertices, frame_count);
  parallel_for_indices(runners.size(), [&](std::size_t r) {
    const std::vector<Station> stations = run(runners[r]);
    for (std::size_t f = 0; f < frame_count; ++f) {
      const Pose pose = sprinter(stations[f].stride);
      for (std::size_t part = 0; part < part_count; ++part) {
        const Frame at = placed(stations[f].frame, pose[part]);
        const std::size_t which = r * part_count + part;
        for (std::size_t v = first[which]; v < first[which + 1]; ++v) frames[f][v] = at.at(directions[v - first[0]]);
      }
    }
  });
  set_frames(scene, std::move(frames));
  scene.materials = stands_materials();
  scene.materials.push_back({.name = "skin", .color = {0.52F, 0.34F, 0.24F}});
  scene.materials.push_back({.name = "red", .color = {0.66F, 0.10F, 0.09F}});
  scene.materials.push_back({.name = "yellow", .color = {0.80F, 0.66F, 0.12F}});
  scene.materials.push_back({.name = "green", .color = {0.10F, 0.42F, 0.20F}});
  scene.materials.push_back({.name = "white", .color = {0.80F, 0.80F, 0.78F}});
  scene.lights = {
      {.name = "sun", .position = {-0.45F, 0.65F, -0.35F}, .intensity = {1.1F, 1.05F, 0.95F}, .point_at_infinity = true}};
  scene.cameras = {{.name = "track", .eye = {0, 5, 22}, .target = {0, 1.5F, 48}, .vertical_fov = 48},
                   {.name = "finish", .eye = {17, 1.7F, 45}, .target = {-6, 0.9F, 47}, .vertical_fov = 38}};
}

const ProceduralRegistration registration{"runners", "animated: sprinters with swinging limbs cross a large stadium",
                                          make_runners, frame_count};

}  // namespace
}  // namespace raystudy::procedural
