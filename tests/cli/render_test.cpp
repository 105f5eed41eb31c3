#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/cli/raystudy.h"

namespace raystudy {
namespace {

class Render : public testing::Test {
 protected:
  Render() { std::filesystem::create_directories(folder_); }
  ~Render() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string file(const std::string& name) const { return (folder_ / name).string(); }
  void expect_error(const std::string& arguments, const std::string& message) const {
    const Outcome outcome = raystudy("render " + arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.text, message + "\n");
    EXPECT_TRUE(std::filesystem::is_empty(folder_));
  }

 private:
  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / fmt::format("raystudy-render-{}", ::getpid());
};

constexpr const char* small = "atrium --triangles 1000 --width 32 --height 24 --samples 1 --ambient-rays 1";

TEST_F(Render, ShadesAScene) {
  for (const char* name : {"a.png", "a.exr"}) {
    const Outcome outcome = raystudy(fmt::format("render {} --camera gallery -o {}", small, file(name)));
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_THAT(outcome.text, testing::HasSubstr("atrium of 1002 triangles, camera 'gallery'"));
    EXPECT_GT(std::filesystem::file_size(file(name)), 100U);
  }
}

TEST_F(Render, MapsTraversalSteps) {
  const std::string map = fmt::format("render {} --heat-map --workload primary -o ", small);
  const Outcome outcome = raystudy(map + file("h.png") + " --optimize insertion --max-steps 60");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_THAT(outcome.text, testing::HasSubstr("traversal steps per ray"));
  EXPECT_TRUE(std::filesystem::exists(file("h.png")));
  EXPECT_EQ(raystudy(map + file("h.exr")).code, 0);
}

TEST_F(Render, ComparesBeforeAndAfterOptimization) {
  const Outcome outcome = raystudy(fmt::format("render {} --compare --optimize insertion -o {}", small, file("c.png")));
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(std::filesystem::exists(file("c.png")));
}

TEST_F(Render, ShowsAnAnimationAtATimeOrOnAContactSheet) {
  const std::string animated = "render fracture --triangles 1000 --width 32 --height 24 --samples 1 --ambient-rays 1 -o ";
  std::vector<std::string> pictures;
  for (const char* time : {"", " --time 0", " --time 0.5", " --time 1"}) {
    const Outcome outcome = raystudy(animated + file("t.exr") + time);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    std::ifstream picture(file("t.exr"), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(picture), std::istreambuf_iterator<char>()};
    constexpr std::size_t pixels = std::size_t{32} * 24 * 3 * sizeof(float);  // at the file's end; its beginning holds the date
    ASSERT_GT(bytes.size(), pixels);
    pictures.push_back(bytes.substr(bytes.size() - pixels));
  }
  EXPECT_TRUE(pictures[0] == pictures[1]) << "the first key frame";
  EXPECT_FALSE(pictures[1] == pictures[2]);
  EXPECT_FALSE(pictures[2] == pictures[3]);
  for (const char* more : {" --frames 5", " --frames 3 --heat-map --workload primary"}) {
    const Outcome outcome = raystudy(animated + file("sheet.png") + more);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
  }
}

TEST_F(Render, TimesNeedAnAnimation) {
  const std::string message = "scene 'atrium' does not move; expected a scene with key frames for --time and --frames";
  expect_error("atrium --triangles 1000 --time 0 -o " + file("a.png"), message);
  expect_error("atrium --triangles 1000 --frames 2 -o " + file("a.png"), message);
  expect_error("fracture --frames 2 -o " + file("a.exr"), "--frames with an .exr file; expected either alone");
  expect_error("fracture --frames 2 --compare --optimize insertion -o " + file("a.png"),
               "--frames with --compare; expected either alone");
  const Outcome outcome = raystudy("render fracture --triangles 1000 --time 1.5 -o " + file("a.png"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, testing::HasSubstr("1.5"));
}

TEST_F(Render, ComparingNeedsAnOptimizer) {
  expect_error("atrium --compare -o " + file("a.png"), "--compare has nothing to compare; expected an optimizer, by --optimize");
}

TEST_F(Render, UnknownSceneGivesTheNearest) {
  expect_error("atrim -o " + file("a.png"),
               "there is no scene 'atrim'; expected a name that 'raystudy scene list' shows; did you mean 'atrium'?");
}

TEST_F(Render, UnknownCameraGivesTheNearest) {
  const std::string message = "scene 'atrium' has no camera 'cort'; expected one of court, gallery; did you mean 'court'?";
  expect_error("atrium --triangles 1000 --camera cort -o " + file("a.png"), message);
  expect_error("atrium --triangles 1000 --heat-map --camera cort -o " + file("a.png"), message);
}

TEST_F(Render, TriangleCountsHaveARange) {
  expect_error("atrium --triangles 10 -o " + file("a.png"),
               "scene 'atrium' of 10 triangles; expected 1000 to 100000000 triangles");
}

TEST_F(Render, OnlyPngAndExrAreWritten) {
  expect_error("atrium -o a.jpg", "cannot write 'a.jpg' as an image; expected a name ending in .png or .exr");
}

TEST_F(Render, UnwritableOutput) {
  expect_error("atrium -o /proc/nowhere/a.png", "/proc/nowhere: cannot make the folder: No such file or directory");
}

TEST_F(Render, SamplesAreASquare) {
  expect_error("atrium --samples 3 -o " + file("a.png"), "--samples is 3; expected a square number such as 4");
}

TEST_F(Render, MethodsMustFit) {
  expect_error("atrium --builder embree --tracer scalar -o " + file("a.png"),
               "tracer 'scalar' cannot trace what builder 'embree' makes ('embree'); expected one of embree");
  expect_error("atrium --triangles 1000 --heat-map --builder embree -o " + file("a.png"),
               "this tracer cannot count traversal steps; expected a tracer that counts, such as 'scalar'");
  expect_error("atrium --heat-map --workload random -o " + file("a.png"),
               "the rays of workload 'random' do not belong to pixels; expected one of ambient-occlusion, primary, reflection, shadow");
  const Outcome outcome = raystudy("render atrium --builder sweep-sha -o " + file("a.png"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, testing::HasSubstr("did you mean 'sweep-sah'?"));
}

}  // namespace
}  // namespace raystudy
