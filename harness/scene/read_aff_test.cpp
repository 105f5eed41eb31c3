#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/scene/read.h"
#include "harness/scene/test_files.h"

namespace raystudy {
namespace {

using ::testing::internal::CaptureStderr;
using ::testing::internal::GetCapturedStderr;

class Aff : public ::testing::Test {
 protected:
  [[nodiscard]] Scene read(const std::string& text) const { return read_scene(environment.folder.write("scene.aff", text)); }
  [[nodiscard]] std::string error(const std::string& text) const {
    std::string message = test::error_of([&] { (void)read(text); });
    const std::string folder = environment.folder.text() + "/";
    for (auto at = message.find(folder); at != std::string::npos; at = message.find(folder)) message.erase(at, folder.size());
    return message;
  }
  /// The triangle in a scope that moves as `keys` say, at the five whole seconds from 0 to 4.
  [[nodiscard]] Scene moving(const std::string& keys) const {
    return read("a 0 4 5\nx thing { p 3  0 0 0  1 0 0  0 1 0 }\nk thing { " + keys + " }\n");
  }
  test::CleanEnvironment environment;
};

void expect_at(const Scene& scene, std::size_t frame, std::size_t vertex, Vec3 wanted) {
  ASSERT_LT(frame, scene.frames.size());
  const Vec3 found = scene.frames[frame][vertex];
  EXPECT_NEAR(found.x, wanted.x, 1e-6) << "frame " << frame;
  EXPECT_NEAR(found.y, wanted.y, 1e-6) << "frame " << frame;
  EXPECT_NEAR(found.z, wanted.z, 1e-6) << "frame " << frame;
}

TEST_F(Aff, GeometryScopesAndIncludedFiles) {
  environment.folder.write("part.aff", "xs 1 1 1  0 0 1 90  0 0 5\n{ tt wall.ppm  1 0 0 0 0  2 0 0 1 0  1 1 0 0 1 }\n");
  const Scene scene = read(R"(% a comment
b 0 0 1  # the background
v from 0 1 8 at 0 1 0 up 0 1 0 angle 40 hither 0.1 resolution 800 600
l 1 2 3  0.5 0.5 0.25
am 1 1 1
fm 0.1 0.1 0.1  0.5 0.25 0.125  0 0 0  20 0 0
p 4  0 0 0  1 0 0  1 1 0  0 1 0
fm 0 0 0  0 0 0  0 0 0  1 0.75 1.5
xs 2 2 2  0 1 0 0  10 0 0
{
m vertices 3  0 0 0  1 0 0  0 1 0  normals 1  0 0 1  texturecoords 2 a.ppm  0 0  1 1
  triangles 1  0 1 2  0 0 0  1 1 0
i 0 part.aff
}
)");
  ASSERT_EQ(scene.triangles.size(), 4U);
  EXPECT_TRUE(scene.frames.empty());
  const auto corner = [&](std::size_t t, int i) { return scene.vertices[scene.triangles[t][i]]; };
  EXPECT_EQ(corner(1, 2), (Vec3{0, 1, 0}));
  EXPECT_EQ(corner(2, 1), (Vec3{12, 0, 0}));
  // (2, 0, 0): turned to (0, 2, 0), moved to (0, 2, 5), scaled to (0, 4, 10), moved to (10, 4, 10).
  EXPECT_NEAR(corner(3, 1).x, 10, 1e-6);
  EXPECT_NEAR(corner(3, 1).y, 4, 1e-6);
  EXPECT_NEAR(corner(3, 1).z, 10, 1e-6);
  EXPECT_EQ(scene.material_of(0).color, (Vec3{0.5F, 0.25F, 0.125F}));
  EXPECT_EQ(scene.material_of(3).kind, MaterialKind::refractive);
  EXPECT_EQ(scene.material_of(3).refraction_index, 1.5F);
  EXPECT_EQ(scene.camera("view").eye, (Vec3{0, 1, 8}));
  EXPECT_EQ(scene.camera("view").vertical_fov, 40);
  EXPECT_EQ(scene.lights.at(0).intensity, (Vec3{0.5F, 0.5F, 0.25F}));
}

TEST_F(Aff, TranslationsByHand) {
  // Tangents at the second and third key: 4/3 · 4/2 = 8/3 and 4/3 · (4 + 3)/2 = 14/3; half way 0.5 · 4 + (8/3 - 14/3)/8 = 1.75.
  const Scene scene = moving("transl 4  0 0 0 0 0 0 0  1 0 0 0 0 0 0  3 4 0 0 0 0 0  4 7 0 0 0 0 0");
  ASSERT_EQ(scene.frames.size(), 5U);
  expect_at(scene, 0, 0, {0, 0, 0});  // the first key only shapes the curve
  expect_at(scene, 1, 0, {0, 0, 0});
  expect_at(scene, 2, 0, {1.75F, 0, 0});
  expect_at(scene, 3, 0, {4, 0, 0});
  expect_at(scene, 4, 0, {4, 0, 0});  // as the last
}

TEST_F(Aff, TensionContinuityAndBias) {
  const auto half_way = [this](const std::string& shape) {
    const Scene scene = moving(fmt::format("transl 4  0 1 0 0 0 0 0  1 0 0 0 {}  3 4 0 0 1 0 0  4 7 0 0 0 0 0", shape));
    return scene.frames[2][0].x;
  };
  // The third key has tension 1, so no tangent; of the second it is 4/3 of half the differences -1 and 4.
  EXPECT_NEAR(half_way("0 0 0"), 2 + (4.0 / 3) * (-0.5 + 2) / 8, 1e-6);
  EXPECT_NEAR(half_way("0.5 0 0"), 2 + 0.5 * (4.0 / 3) * (-0.5 + 2) / 8, 1e-6);
  EXPECT_NEAR(half_way("0 0.5 0"), 2 + (4.0 / 3) * (-0.5 * 1.5 + 2 * 0.5) / 8, 1e-6);
  EXPECT_NEAR(half_way("0 0 0.5"), 2 + (4.0 / 3) * (-0.5 * 1.5 + 2 * 0.5) / 8, 1e-6);
}

TEST_F(Aff, RotationsFollowTheSameCurveAroundTheirAxis) {
  // The numbers of TranslationsByHand in units of 20 degrees.
  const Scene scene = moving("rot 4  0 0 0 3 0 0 0 0  1 0 0 3 0 0 0 0  3 0 0 3 80 0 0 0  4 0 0 3 140 0 0 0");
  expect_at(scene, 2, 1, {0.81915204F, 0.57357644F, 0});  // 35 degrees
  expect_at(scene, 4, 1, {0.17364818F, 0.98480775F, 0});  // 80
}

TEST_F(Aff, WholeTurnsAreNoTurnAndTimesMayGoBack) {
  const Scene scene = moving(
      "rot 6  0 0 0 1 0 0 0 0  0 0 0 1 0 0 0 0  1 0 0 1 360 0 0 0  0.5 0 0 1 0 0 0 0  3 0 0 1 0 0 0 0  "
      "4 0 0 1 0 0 0 0");
  EXPECT_TRUE(scene.frames.empty()) << "nothing moves";
}

TEST_F(Aff, ScopesWithinScopes) {
  const Scene scene = read(R"(a 0 4 5
x outer { xs 1 1 1  0 0 1 90  5 0 0 { x inner { p 3  0 0 0  1 0 0  0 1 0 } p 3  0 0 0  1 0 0  0 1 0 } }
p 3  0 0 0  1 0 0  0 1 0
k outer { transl 4  0 0 0 0 0 0 0  1 0 0 0 1 0 0  3 0 0 8 1 0 0  4 0 0 8 0 0 0 }
k inner { scale 4  0 1 1 1 0 0 0  1 1 1 1 1 0 0  3 3 1 1 1 0 0  4 3 1 1 0 0 0 }
)");
  ASSERT_EQ(scene.vertices.size(), 9U) << "three that stand, three of each scope";
  const auto corner = [&](std::size_t f, std::size_t t, int i) { return scene.frames[f][scene.triangles[t][i]]; };
  EXPECT_NEAR(corner(0, 0, 1).y, 1, 1e-6);
  EXPECT_NEAR(corner(3, 0, 1).y, 3, 1e-6);
  EXPECT_NEAR(corner(3, 0, 1).x, 5, 1e-6);
  EXPECT_NEAR(corner(3, 0, 1).z, 8, 1e-6);
  EXPECT_NEAR(corner(2, 1, 1).z, 4, 1e-6);
  EXPECT_NEAR(corner(3, 1, 1).y, 1, 1e-6);
  EXPECT_EQ(corner(3, 2, 1), (Vec3{1, 0, 0}));
}

TEST_F(Aff, TrianglesThatChangeTheirShape) {
  const Scene scene =
      read("a 0 4 5\ntpa 2\n1  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n3  0 0 2 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n");
  for (const auto& [frame, z] :
       {std::pair{0, 0.0F}, std::pair{1, 0.0F}, std::pair{2, 1.0F}, std::pair{3, 2.0F}, std::pair{4, 2.0F}}) {
    expect_at(scene, static_cast<std::size_t>(frame), 0, {0, 0, z});
  }
}

TEST_F(Aff, FramesAreThreeHundredAtTheMost) {
  const std::string rest = "\ntpa 2\n1  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n3  0 0 2 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n";
  EXPECT_EQ(read("a 0 4 7" + rest).frames.size(), 7U);
  EXPECT_EQ(read("a 0 4 800" + rest).frames.size(), 300U);
}

TEST_F(Aff, WarnsOfWhatIsLeftOut) {
  CaptureStderr();
  const Scene scene = read("c 0 0 0 1  0 1 0 0\nx lost { p 3  0 0 0  1 0 0  0 1 0 }\n");
  EXPECT_EQ(
      GetCapturedStderr(),
      fmt::format("warning: {0}: no file gives the key frames lost: what they should move stands still\nwarning: {0}: 1 cones "
                  "are left out\n",
                  environment.folder.text() + "/scene.aff"));
  EXPECT_EQ(scene.triangles.size(), 1U);
}

TEST_F(Aff, Errors) {
  EXPECT_EQ(error("q 3"),
            "scene.aff:1:1: 'q' is no command of AFF that is read; expected one of i, }, a, am, b, c, fm, k, l, m, p, "
            "tpa, tt, v, x, xs");
  EXPECT_EQ(error("p 3 0 0 0\n 1 zero 0"), "scene.aff:2:4: 'zero' stands where a coordinate should; expected a number");
  EXPECT_EQ(error("p 3 0 0"), "scene.aff:1:8: the file ends where a coordinate should stand; expected a complete file");
  EXPECT_EQ(error("p 2 0 0 0 1 1 1"), "scene.aff:1:3: a polygon has 2 corners; expected three or more");
  EXPECT_EQ(error("p 900 0 0 0"), "scene.aff:1:3: 900 corners do not fit into the file; expected a complete file");
  EXPECT_EQ(error("m vertices 1 0 0 0 triangles 1 0 0 1"),
            "scene.aff:1:36: a triangle refers to vertex 1 of its mesh; expected an index below 1");
  EXPECT_EQ(error("i 0 lost.aff"), "scene.aff:1:5: there is no file 'lost.aff' beside scene.aff; expected an included file");
  EXPECT_EQ(error("i 0 scene.aff"), "scene.aff: files include each other deeper than 100; expected no circle");
  EXPECT_EQ(error("x a { p 3 0 0 0 1 0 0 0 1 0"), "scene.aff:1:28: the file ends within 1 scopes; expected '}' for each '{'");
  EXPECT_EQ(error("}"), "scene.aff:1:1: '}' closes nothing; expected '{' before it");
  EXPECT_EQ(error("x a p 3"), "scene.aff:1:5: 'p' follows x; expected '{'");
  EXPECT_EQ(error("a 0 0 5"),
            "scene.aff:1:7: the animation has 5 frames from 0 to 0; expected a whole number of frames, two at least, and time to "
            "pass");
  for (const std::string frames : {"0", "-5", "2.5"}) {
    EXPECT_EQ(error("a 0 4 " + frames),
              "scene.aff:1:7: the animation has " + frames +
                  " frames from 0 to 4; expected a whole number of frames, two at least, and time to pass");
  }
  EXPECT_EQ(error("a 0 4 nan"),
            "scene.aff:1:7: 'nan' stands where the animation's begin, end and number of frames should; expected a finite number");
  EXPECT_EQ(error("k a { transl 4 0 0 0 0 0 0 0\n1 0 nan 0 0 0 0 2 0 0 0 0 0 0 3 0 0 0 0 0 0 }"),
            "scene.aff:2:5: 'nan' stands where a translation should; expected a finite number");
  EXPECT_EQ(error("k a { transl 4 0 0 0 0 0 0 0\ninf 0 0 0 0 0 0 2 0 0 0 0 0 0 3 0 0 0 0 0 0 }"),
            "scene.aff:2:1: 'inf' stands where a time should; expected a finite number");
  EXPECT_EQ(error("p 3 0 0 0 1 0 0 0 1e999 0"),
            "scene.aff:1:19: '1e999' stands where a coordinate should; expected a finite number");
  EXPECT_EQ(error("a 0 4 5\nx a { p 3 0 0 0 1 0 0 0 1 0 }\nk a { transl 4 0 0 0 0 0 0 0 1 0 0 0 0 0 0 3 1e300 0 0 0 0 0 4 0 0 "
                  "0 0 0 0 }"),
            "scene.aff: vertex 0 of frame 2 is (inf, 0, 0); expected finite coordinates");
  EXPECT_EQ(error("k a { transl 3 0 0 0 0 0 0 0 }"),
            "scene.aff:1:14: a has 3 keys; expected four at least: the first and the last only shape the curve");
  EXPECT_EQ(error("k a { trans 4 }"),
            "scene.aff:1:7: 'trans' stands where keys of a should; expected transl, rot or scale; did you mean 'transl'?");
  EXPECT_EQ(error("k a { }\nk a { transl 4 " + std::string("0 0 0 0 0 0 0 1 0 0 0 0 0 0 2 0 0 0 0 0 0 3 0 0 0 0 0 0 }")),
            "scene.aff:2:72: the key frames 'a' are given twice; expected once");
  EXPECT_EQ(error("tpa 2 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1"),
            "scene.aff:1:45: shape 1 of a triangle is at 1 s; expected increasing times");
}

/// The sampled sequences of the catalog were made of the same files by other hands.
void expect_same_ends(const std::string& name, float tolerance) {
  const Catalog catalog = read_catalog(catalog_path());
  for (const std::string& one : {name, name + "-aff"}) {
    if (const auto why = why_not_installed(catalog, one)) GTEST_SKIP() << *why;
  }
  const Scene sampled = open_scene(catalog, name, 0, 1);
  const Scene original = open_scene(catalog, name + "-aff", 0, 1);
  ASSERT_EQ(original.frames.size(), 300U);
  for (const auto& [a, b] :
       {std::pair{sampled.frames.front(), original.frames.front()}, std::pair{sampled.frames.back(), original.frames.back()}}) {
    float worst = 0;
    for (std::size_t t = 0; t < sampled.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) worst = std::max(worst, length(a[sampled.triangles[t][i]] - b[original.triangles[t][i]]));
    }
    EXPECT_LT(worst, tolerance) << name;
  }
}

TEST(AffOriginals, KitchenIsTheSampledOne) { expect_same_ends("bart-kitchen", 1e-5F); }
TEST(AffOriginals, MuseumIsTheSampledOne) { expect_same_ends("bart-museum5", 1e-5F); }
// Heads and grips turn around axes that are not of unit length; there the two differ between keys.
TEST(AffOriginals, RobotsAreTheSampledOnes) { expect_same_ends("bart-robots", 0.1F); }

}  // namespace
}  // namespace raystudy
