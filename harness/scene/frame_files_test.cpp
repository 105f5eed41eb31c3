#include "harness/scene/frame_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "harness/scene/load.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// A square of two triangles as PLY whose first vertex is at height z, written as text.
std::string square(const std::string& z, const std::string& second_triangle = "0 2 3") {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
         "property list uchar int vertex_indices\nend_header\n0 0 " +
         z + "\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 " + second_triangle + "\n";
}

/// Positions of the square's four vertices in n frames, all zero.
std::string zeros(std::size_t n) { return std::string(n * 4 * sizeof(Vec3), '\0'); }

/// A model and its frames, in a folder that messages do not show.
class FrameFiles : public ::testing::Test {
 protected:
  struct Content {
    std::string name;
    std::string text;
  };
  Scene load(const std::vector<Content>& frames) {
    std::vector<FileToRead> files;
    for (const Content& frame : frames) files.push_back({environment.folder.write(frame.name, frame.text)});
    return load_scene({environment.folder.write(model.name, model.text)}, files);
  }
  std::string error(const std::vector<Content>& frames) {
    std::string text = test::error_of([&] { (void)load(frames); });
    const std::string folder = environment.folder.text() + "/";
    for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder)) text.erase(at, folder.size());
    return text;
  }
  Content model{"model.ply", square("0")};
  test::CleanEnvironment environment;
};

TEST_F(FrameFiles, ModelsAndSequencesFollowEachOther) {
  const Scene scene = load({{"a.ply", square("0")}, {"b.f32", zeros(2)}, {"c.ply", square("7")}});
  ASSERT_EQ(scene.frames.size(), 4U);
  EXPECT_EQ(scene.frames[3][0], (Vec3{0, 0, 7}));
  EXPECT_EQ(scene.frames[2][3], Vec3{});
}

TEST_F(FrameFiles, OtherTopology) {
  const Content first{"a.ply", square("0")};
  EXPECT_EQ(error({first, {"b.obj", "v 0 0 0\nf 1 1 1\n"}}),
            "b.obj: frame 1 has 1 vertices and 1 triangles; expected 4 and 2, as model.ply has");
  EXPECT_EQ(error({first, {"b.f32", zeros(2)}, {"c.ply", square("1", "0 3 2")}}),
            "c.ply: triangle 1 of frame 3 joins the vertices 0, 3 and 2; expected 0, 2 and 3, as in model.ply");
}

TEST_F(FrameFiles, SequencesThatDoNotEndWithAFrame) {
  EXPECT_EQ(error({{"a.f32", ""}}),
            "a.f32: the sequence has no frame; expected a multiple of 48 bytes: 4 vertices of three floats a frame");
  EXPECT_EQ(error({{"a.f32", zeros(1) + "more"}}),
            "a.f32: the sequence has 52 bytes and ends within frame 1; expected a multiple of 48 "
            "bytes: 4 vertices of three floats a frame");
  EXPECT_EQ(error({{"a.ply", square("0")}, {"b.f32", zeros(2) + "more"}}),
            "b.f32: the sequence has 100 bytes and ends within frame 3; "
            "expected a multiple of 48 bytes: 4 vertices of three floats a frame");
}

TEST_F(FrameFiles, VerticesThatAreNotFinite) {
  EXPECT_EQ(error({{"a.ply", square("0")}, {"b.ply", square("nan")}}),
            "b.ply: vertex 0 of frame 1 is (0, 0, nan); expected finite coordinates");
  std::string frames = zeros(3);
  frames.replace(2 * 48 + 3 * sizeof(Vec3), 4, test::packed(nan));
  EXPECT_EQ(error({{"a.ply", square("0")}, {"b.f32", frames}}),
            "b.f32: vertex 3 of frame 3 is (nan, 0, 0); expected finite coordinates");
}

TEST_F(FrameFiles, ModelsThatMoveOfThemselves) {
  const Content moving{"moving.aff",
                       "a 0 4 5\ntpa 2\n1  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n3  0 0 2 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1\n"};
  EXPECT_EQ(error({{"a.ply", square("0")}, moving}),
            "moving.aff: frame 1 moves of itself, in 5 key frames; expected a model that stands still");
  model = moving;
  EXPECT_EQ(error({{"a.ply", square("0")}}),
            "moving.aff: the model moves of itself, in 5 key frames, and has 1 files of frames; expected one of both");
}

TEST_F(FrameFiles, MissingFile) {
  EXPECT_EQ(test::error_of([&] {
              (void)load_scene({environment.folder.write(model.name, model.text)}, {{environment.folder.text() + "/a.ply"}});
            }),
            environment.folder.text() + "/a.ply: there is no such file");
}

}  // namespace
}  // namespace raystudy
