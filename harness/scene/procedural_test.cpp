#include "harness/scene/procedural.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "harness/base/error.h"

namespace raystudy {
namespace {

using testing::ElementsAre;

std::string message_of(std::string_view name, std::int64_t triangles) {
  try {
    (void)make_procedural(name, triangles, 1);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const ProceduralInfo& info : procedural_scenes()) all.push_back(info.name);
  return all;
}

class Procedural : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, Procedural, testing::ValuesIn(names()), [](const auto& scene) { return scene.param; });

TEST_P(Procedural, HasTheTrianglesAskedForWithinFivePercent) {
  for (const std::int64_t wanted : {1'000, 1'234, 2'000, 3'700, 5'000, 8'100, 10'000, 20'000, 55'000, 100'000, 210'000}) {
    const auto got = static_cast<double>(make_procedural(GetParam(), wanted, 1).triangles.size());
    EXPECT_NEAR(got, static_cast<double>(wanted), 0.05 * static_cast<double>(wanted));
  }
}

TEST_P(Procedural, IsTheSameForASeed) {
  EXPECT_EQ(make_procedural(GetParam(), 30'000, 7).hash, make_procedural(GetParam(), 30'000, 7).hash);
  EXPECT_NE(make_procedural(GetParam(), 5'000, 7).hash, make_procedural(GetParam(), 5'000, 8).hash);
}

TEST_P(Procedural, HasFiniteVerticesAndNoTriangleWithoutArea) {
  for (const std::int64_t triangles : {1'000, 60'000}) {
    const Scene scene = make_procedural(GetParam(), triangles, 3);
    std::size_t flat = 0;
    for (const Triangle& t : scene.triangles) {
      const Vec3 a = scene.vertices[t[0]];
      if (length(cross(scene.vertices[t[1]] - a, scene.vertices[t[2]] - a)) == 0) ++flat;
    }
    EXPECT_EQ(flat, 0U) << triangles;
    for (const Vec3 v : scene.vertices) ASSERT_TRUE(is_finite(v));
  }
}

TEST_P(Procedural, HasTwoNamedCamerasThatSeeItAndALight) {
  const Scene scene = make_procedural(GetParam(), 10'000, 1);
  ASSERT_GE(scene.cameras.size(), 2U);
  EXPECT_NE(scene.cameras[0].name, scene.cameras[1].name);
  EXPECT_FALSE(scene.lights.empty());
  for (const Camera& camera : scene.cameras) {
    // The view's axis passes through the scene's box, which the target lies in.
    EXPECT_TRUE(scene.bounds.contains(Box(camera.target, camera.target))) << camera.name;
    EXPECT_GT(length(camera.target - camera.eye), 0) << camera.name;
    EXPECT_LT(length(camera.eye - scene.bounds.center()), 2 * scene.diagonal()) << camera.name;
  }
}

// The scenes are the same to the bit on every machine: these hashes were made once and hold everywhere.
TEST(ProceduralScenes, KeepTheirHashes) {
  std::map<std::string, std::string> hashes;
  for (const std::string& name : names()) hashes[name] = make_procedural(name, 2'000, 1).hash;
  const std::map<std::string, std::string> expected{
      {"atrium", "2029142fb54fe0bbf67a8af55f725ae7"}, {"balls", "952a415938ffc6045f236ade8a6bb59d"},
      {"cloth", "cd0a500bb923b8dc17dde936835d1539"},  {"runners", "d6bdaab3dbb64dd84d1a7024e91752c9"},
      {"city", "c002cc5533dab039e529f52240e22ad5"},   {"fracture", "a174ec8d40c6725e3bc5eea02d918d36"},
      {"museum", "4a1ec4463c2f8a1f6cdd9ef2c4032177"}, {"scan", "27a09fc0dbcbbc61efe8e85bad9498ab"},
      {"soup", "3e37af1dbe63946d73c020abb0f1d677"},   {"stadium", "dd19257abce32dc87c08a9a0ce8861a5"},
      {"terrain", "184069dd747e6bc824e469f1de1a760c"}};
  EXPECT_EQ(hashes, expected);
}

TEST(ProceduralScenes, AreThose) {
  EXPECT_THAT(names(), ElementsAre("atrium", "balls", "city", "cloth", "fracture", "museum", "runners", "scan", "soup", "stadium",
                                   "terrain"));
}

TEST(ProceduralScenes, ScanIsClosed) {
  for (const std::int64_t triangles : {1'000, 1'001, 7'777, 50'000}) {
    const Scene scene = make_procedural("scan", triangles, 5);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;  // directed edges: +1 there, -1 back
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
    for (const Triangle& t : scene.triangles) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i];
        const std::uint32_t b = t[(i + 1) % 3];
        balance[std::minmax(a, b)] += a < b ? 1 : -1;
        ++uses[std::minmax(a, b)];
      }
    }
    for (const auto& [edge, count] : uses) ASSERT_EQ(count, 2) << edge.first << '-' << edge.second << " of " << triangles;
    for (const auto& [edge, sum] : balance) ASSERT_EQ(sum, 0) << "neighbours turn the same way";
    // Euler: a closed surface without handles has V - E + F = 2.
    EXPECT_EQ(scene.vertices.size() + scene.triangles.size() - uses.size(), 2U);
  }
}

TEST(ProceduralScenes, ScanHasEvenTriangles) {
  const Scene scene = make_procedural("scan", 100'000, 1);
  std::vector<float> areas;
  for (const Triangle& t : scene.triangles) {
    const Vec3 a = scene.vertices[t[0]];
    areas.push_back(length(cross(scene.vertices[t[1]] - a, scene.vertices[t[2]] - a)));
  }
  std::sort(areas.begin(), areas.end());
  EXPECT_LT(areas[areas.size() * 9 / 10], 4 * areas[areas.size() / 10]);
}

TEST(ProceduralScenes, StadiumIsATeapotInAStadium) {
  const Scene scene = make_procedural("stadium", 50'000, 1);
  std::size_t near = 0;
  for (const Triangle& t : scene.triangles) {
    if (length(scene.vertices[t[0]]) < 1.2F) ++near;
  }
  EXPECT_GT(near, scene.triangles.size() / 2);
  EXPECT_GT(scene.diagonal(), 400);
}

TEST(ProceduralScenes, CityIsTurnedOffTheAxesAndHasLongThinTriangles) {
  const Scene scene = make_procedural("city", 50'000, 1);
  std::size_t slanted = 0;
  std::size_t thin = 0;
  for (const Triangle& t : scene.triangles) {
    const std::array<Vec3, 3> p{scene.vertices[t[0]], scene.vertices[t[1]], scene.vertices[t[2]]};
    const float longest = std::max({length(p[1] - p[0]), length(p[2] - p[1]), length(p[0] - p[2])});
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    if (length(normal) / (longest * longest) < 0.1F) ++thin;  // height below a tenth of the longest side
    if (std::fabs(normal.x) > 0.05F * length(normal) && std::fabs(normal.z) > 0.05F * length(normal)) ++slanted;
  }
  EXPECT_GT(slanted, scene.triangles.size() / 2);
  EXPECT_GT(thin, scene.triangles.size() / 4);
}

TEST(ProceduralScenes, UnknownNameGivesTheNearest) {
  EXPECT_EQ(message_of("atrum", 1000),
            "there is no procedural scene 'atrum'; expected one of atrium, balls, city, cloth, fracture, museum, runners, scan, "
            "soup, stadium, terrain; did you mean 'atrium'?");
}

TEST(ProceduralScenes, CountsHaveARange) {
  EXPECT_EQ(message_of("soup", 999), "scene 'soup' of 999 triangles; expected 1000 to 100000000 triangles");
  EXPECT_EQ(message_of("soup", 100'000'001), "scene 'soup' of 100000001 triangles; expected 1000 to 100000000 triangles");
  EXPECT_EQ(message_of("city", -5), "scene 'city' of -5 triangles; expected 1000 to 100000000 triangles");
}

}  // namespace
}  // namespace raystudy
