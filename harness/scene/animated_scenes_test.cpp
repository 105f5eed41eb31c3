#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "harness/base/error.h"
#include "harness/base/parallel.h"
#include "harness/scene/procedural.h"

namespace raystudy {
namespace {

std::vector<ProceduralInfo> animated() {
  std::vector<ProceduralInfo> all;
  for (const ProceduralInfo& info : procedural_scenes()) {
    if (info.frames > 0) all.push_back(info);
  }
  return all;
}

class AnimatedScene : public testing::TestWithParam<ProceduralInfo> {
 protected:
  static Scene make(std::int64_t triangles, std::uint64_t seed = 1) { return make_procedural(GetParam().name, triangles, seed); }
};
INSTANTIATE_TEST_SUITE_P(Scenes, AnimatedScene, testing::ValuesIn(animated()),
                         [](const auto& scene) { return scene.param.name; });

std::vector<bool> movers(const Scene& scene) {
  std::vector<bool> moves(scene.vertices.size(), false);
  for (const auto& frame : scene.frames) {
    for (std::size_t v = 0; v < frame.size(); ++v) moves[v] = moves[v] || frame[v] != scene.vertices[v];
  }
  return moves;
}

/// Whether `p` is in the picture of a camera of width 8 to height 5.
bool sees(const Camera& camera, Vec3 p) {
  const Vec3 forward = normalized(camera.target - camera.eye);
  const Vec3 right = normalized(cross(forward, camera.up));
  const Vec3 up = cross(right, forward);
  const Vec3 to = p - camera.eye;
  const float edge = std::tan(camera.vertical_fov * 3.14159265F / 360) * dot(to, forward);
  return std::fabs(dot(to, up)) <= edge && std::fabs(dot(to, right)) <= 1.6F * edge;
}

TEST_P(AnimatedScene, HasTheFramesItPromises) {
  for (const std::int64_t triangles : {1'000, 20'000}) {
    const Scene scene = make(triangles);
    EXPECT_EQ(scene.frames.size(), static_cast<std::size_t>(GetParam().frames));
    EXPECT_TRUE(std::equal(scene.vertices.begin(), scene.vertices.end(), scene.frames[0].begin(), scene.frames[0].end()));
    std::size_t moved = 0;
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      const auto& frame = scene.frames[f];
      ASSERT_EQ(frame.size(), scene.vertices.size());
      for (const Vec3 v : frame) ASSERT_TRUE(is_finite(v)) << "frame " << f;
      if (f > 0 && !std::equal(frame.begin(), frame.end(), scene.frames[f - 1].begin())) ++moved;
    }
    EXPECT_GT(moved, scene.frames.size() / 2);
  }
}

TEST_P(AnimatedScene, IsTheSameWhateverTheThreads) {
  std::string one;
  std::string three;
  with_threads(1, [&] { one = make(12'000).hash; });
  with_threads(3, [&] { three = make(12'000).hash; });
  EXPECT_EQ(one, three);
}

TEST_P(AnimatedScene, IsSeenByItsFirstCameraThroughout) {
  const Scene scene = make(10'000);
  const std::vector<bool> moves = movers(scene);
  for (std::size_t f = 0; f < scene.frames.size(); ++f) {
    std::size_t moving = 0;
    std::size_t seen = 0;
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (!moves[v]) continue;
      ++moving;
      if (sees(scene.cameras[0], scene.frames[f][v])) ++seen;
    }
    ASSERT_GT(moving, 0U);
    EXPECT_GT(seen, moving * 3 / 4) << "frame " << f;
  }
}

TEST_P(AnimatedScene, HasAtMostFourMillionTriangles) {
  try {
    (void)make(4'000'001);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "scene '" + GetParam().name + "' of 4000001 triangles; expected 1000 to 4000000 triangles");
  }
}

/// Pairs of vertices at the same place in `frame`, each from another part of the scene's indexing.
std::vector<std::pair<std::size_t, std::size_t>> twins(const SharedArray<Vec3>& frame) {
  std::map<std::tuple<float, float, float>, std::size_t> first;
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t v = 0; v < frame.size(); ++v) {
    const auto [place, fresh] = first.try_emplace({frame[v].x, frame[v].y, frame[v].z}, v);
    if (!fresh) pairs.emplace_back(place->second, v);
  }
  return pairs;
}

double mean_distance(const std::vector<std::pair<std::size_t, std::size_t>>& pairs, const SharedArray<Vec3>& frame) {
  double sum = 0;
  for (const auto& [a, b] : pairs) sum += length(frame[a] - frame[b]);
  return sum / static_cast<double>(pairs.size());
}

TEST(AnimatedScenes, FragmentsOfFractureAreRigid) {
  const Scene scene = make_procedural("fracture", 20'000, 1);
  for (const auto& frame : scene.frames) {
    for (const Triangle& t : scene.triangles) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i];
        const std::uint32_t b = t[(i + 1) % 3];
        ASSERT_NEAR(length(frame[a] - frame[b]), length(scene.vertices[a] - scene.vertices[b]), 2e-6);
      }
    }
  }
}

TEST(AnimatedScenes, FragmentsOfFractureStayInTheRoomAndComeToRest) {
  const Scene scene = make_procedural("fracture", 20'000, 1);
  for (const auto& frame : scene.frames) {
    for (const Vec3 v : frame) {
      ASSERT_GT(v.y, -0.02F);
      ASSERT_LT(std::fabs(v.x), 1.52F);
      ASSERT_LT(std::fabs(v.z), 1.12F);
    }
  }
  std::size_t lying = 0;
  for (const Vec3 v : scene.frames.back()) {
    if (v.y < 0.15F) ++lying;
  }
  EXPECT_GT(lying, scene.vertices.size() / 2);
}

TEST(AnimatedScenes, NeighboursOfFractureEndFarApart) {
  const Scene scene = make_procedural("fracture", 20'000, 1);
  const auto pairs = twins(scene.vertices);  // corners that cuts have made two of
  EXPECT_GT(pairs.size(), 2'000U);
  EXPECT_EQ(mean_distance(pairs, scene.frames.front()), 0);
  const double bust_height = 1.49;
  EXPECT_GT(mean_distance(pairs, scene.frames.back()), bust_height / 2);
}

TEST(AnimatedScenes, SculpturesOfMuseumHaveUnrelatedOrders) {
  const Scene scene = make_procedural("museum", 20'000, 1);
  // Corners that meet in one sculpture, and how far apart they are in the next: as far as two random corners of it.
  for (const auto& [from, to] : {std::pair{0, 30}, std::pair{30, 59}, std::pair{59, 0}}) {
    const auto pairs = twins(scene.frames[static_cast<std::size_t>(from)]);
    const auto& frame = scene.frames[static_cast<std::size_t>(to)];
    EXPECT_GT(pairs.size(), 20'000U) << from;
    double random = 0;
    for (std::size_t i = 1; i < pairs.size(); ++i) random += length(frame[pairs[i].first] - frame[pairs[i - 1].second]);
    EXPECT_NEAR(mean_distance(pairs, frame), random / static_cast<double>(pairs.size() - 1), 0.15) << from << " to " << to;
  }
}

TEST(AnimatedScenes, TrianglesOfMuseumFlyThroughTheHall) {
  const Scene scene = make_procedural("museum", 20'000, 1);
  Box whole;
  Box cloud;
  const std::vector<bool> moves = movers(scene);
  for (std::size_t v = 0; v < moves.size(); ++v) {
    if (!moves[v]) continue;
    whole.extend(scene.frames[0][v]);
    cloud.extend(scene.frames[16][v]);
  }
  EXPECT_GT(cloud.half_area(), 6 * whole.half_area());
  for (int i = 0; i < 3; ++i) {
    EXPECT_GE(cloud.lower[i], scene.bounds.lower[i] - 0.05F);
    EXPECT_LE(cloud.upper[i], scene.bounds.upper[i] + 0.05F);
  }
}

}  // namespace
}  // namespace raystudy
