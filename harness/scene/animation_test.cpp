#include "harness/scene/animation.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "harness/scene/test_files.h"

namespace raystudy {
namespace {

/// A triangle whose first corner rises by 1, then by 3, while the others rest.
Scene moving() {
  Scene scene;
  scene.name = "moving";
  const std::vector<Vec3> at_rest{{0, 0, 0}, {0.1F, 0.7F, 0.3F}, {0, 1, 0}};
  for (const float z : {0.0F, 1.0F, 4.0F}) {
    std::vector<Vec3> positions = at_rest;
    positions[0].z = z;
    scene.frames.emplace_back(std::move(positions));
  }
  scene.vertices = scene.frames.front();
  scene.triangles = SharedArray<Triangle>({Triangle{{0, 1, 2}}});
  finish_scene(scene, "moving");
  return scene;
}

float height(const SharedArray<Vec3>& positions) { return positions[0].z; }

TEST(Animation, UniformTimesIncludeBothEnds) {
  EXPECT_THAT(uniform_times(1), testing::ElementsAre(0.0));
  EXPECT_THAT(uniform_times(5), testing::ElementsAre(0.0, 0.25, 0.5, 0.75, 1.0));
}

TEST(Animation, VerticesMoveInStraightLinesBetweenKeyFrames) {
  const Scene scene = moving();
  EXPECT_EQ(height(positions_at(scene, 0.25)), 0.5F);
  EXPECT_EQ(height(positions_at(scene, 0.75)), 2.5F);
  EXPECT_EQ(positions_at(scene, 0.75)[1], scene.vertices[1]) << "a vertex at rest";
}

TEST(Animation, ATimeIsOnAKeyFrameOrBetweenTwo) {
  const Scene scene = moving();
  const KeyPosition between = key_position(scene, 0.625);
  EXPECT_EQ(between.key, 1U);
  EXPECT_EQ(between.share, 0.25F);
  const KeyPosition last = key_position(scene, 1);
  EXPECT_EQ(last.key, 2U);
  EXPECT_EQ(last.share, 0);
}

TEST(Animation, KeyFramesAreSharedWhateverTheRoundingOfTheirTime) {
  Scene scene = moving();
  for (int i = 3; i < 50; ++i) scene.frames.push_back(scene.frames[static_cast<std::size_t>(i) % 3]);
  const std::vector<double> times = uniform_times(scene.frames.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(positions_at(scene, times[i]).data(), scene.frames[i].data()) << i;
}

TEST(Animation, AStaticSceneIsTheSameAtEveryTime) {
  Scene scene = moving();
  scene.frames.clear();
  EXPECT_EQ(positions_at(scene, 0.3).data(), scene.vertices.data());
  EXPECT_EQ(resampled_frames(scene, 5).size(), 1U);
  EXPECT_EQ(scene_at(scene, 0.3).hash, scene.hash);
}

TEST(Animation, SceneAtATimeIsStaticWithItsOwnBounds) {
  const Scene scene = moving();
  const Scene frame = scene_at(scene, 1);
  EXPECT_TRUE(frame.frames.empty());
  EXPECT_EQ(frame.bounds.upper.z, 4);
  EXPECT_EQ(scene.bounds.upper.z, 0.3F);
  EXPECT_NE(frame.hash, scene_at(scene, 0.5).hash);
  EXPECT_EQ(frame.triangles.data(), scene.triangles.data());
}

TEST(Animation, ResamplingTakesUniformTimes) {
  const std::vector<SharedArray<Vec3>> frames = resampled_frames(moving(), 5);
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(height(frames[1]), 0.5F);
  EXPECT_EQ(height(frames[2]), 1);
  EXPECT_EQ(height(frames[4]), 4);
}

TEST(Animation, APartIsAnAnimationOfItsOwn) {
  const Scene scene = moving();
  const Scene part = part_of(scene, 0.25, 0.75);
  ASSERT_EQ(part.frames.size(), 2U);
  EXPECT_EQ(height(part.vertices), 0.5F);
  EXPECT_EQ(height(part.frames[0]), 0.5F);
  EXPECT_EQ(height(part.frames[1]), 2.5F);
  EXPECT_EQ(part_of(scene, 0, 1).frames[1].data(), scene.frames[1].data());
}

TEST(Animation, Errors) {
  const Scene scene = moving();
  for (const double time : {-0.1, 1.1, std::numeric_limits<double>::quiet_NaN()}) {
    const std::string expected =
        fmt::format("scene 'moving': the time is {}; expected a time from 0 (first frame) to 1 (last)", time);
    EXPECT_EQ(test::error_of([&] { (void)scene_at(scene, time); }), expected);
    EXPECT_EQ(test::error_of([&] { (void)positions_at(scene, time); }), expected);
    EXPECT_EQ(test::error_of([&] { (void)part_of(scene, 0, time); }), expected);
  }
  EXPECT_EQ(test::error_of([&] { (void)part_of(scene, 0.5, 0.5); }),
            "scene 'moving': a part from time 0.5 to 0.5; expected a later end");
  const std::string none = "an animation is sampled at 0 frames; expected 1 at least";
  EXPECT_EQ(test::error_of([] { (void)uniform_times(0); }), none);
  EXPECT_EQ(test::error_of([&] { (void)resampled_frames(scene, 0); }), none);
}

}  // namespace
}  // namespace raystudy
