#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/cli/raystudy.h"
#include "tests/support/files.h"

namespace raystudy {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Tree : public testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& name) const { return folder_.text() + "/" + name; }
  void expect_error(const std::string& arguments, const std::string& message) const {
    const Outcome outcome = raystudy("tree " + arguments);
    EXPECT_EQ(outcome.code, 2);
    EXPECT_EQ(outcome.text, message + "\n");
  }
  /// Saves a tree of a small scene and returns its path.
  [[nodiscard]] std::string saved(const std::string& pipeline = "") const {
    const Outcome outcome = raystudy(fmt::format("tree save terrain {} --triangles 1000 {}", file("a.tree"), pipeline));
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    return file("a.tree");
  }

  test::TempFolder folder_;
};

TEST_F(Tree, BinaryOnesAreSavedShownAndLoaded) {
  const std::string path = saved("--optimize insertion --optimize compaction --seed 1 --c_T 1 --c_I 4");
  const auto content =
      AllOf(HasSubstr("tree         bvh2\n"), HasSubstr("scene        terrain, 1014 triangles, hash "),
            HasSubstr("(c_T = 1, c_I = 4, surface area)\n"), HasSubstr("made under   c_T = 1, c_I = 4, surface-area{}\n"),
            HasSubstr("made with    --triangles 1000\n"), HasSubstr("builder      sweep-sah{"),
            HasSubstr("optimizer    insertion{"), HasSubstr("optimizer    compaction{"));
  const Outcome shown = raystudy("tree info " + path);
  EXPECT_EQ(shown.code, 0);
  EXPECT_THAT(shown.text, content);
  EXPECT_THAT(raystudy("tree info --c_T 2 --c_I 3 " + path).text, HasSubstr("(c_T = 2, c_I = 3, surface area)\n"));
  const Outcome loaded = raystudy("tree load " + path + " --scene terrain --triangles 1000 --rays 500");
  EXPECT_EQ(loaded.code, 0);
  EXPECT_THAT(loaded.text, AllOf(content, HasSubstr("valid        over scene 'terrain'\n"),
                                 HasSubstr("traced by    scalar: closest and any hits of 500 random rays are right\n")));
}

TEST_F(Tree, AreTracedWithoutADriverByTracersThatNeedNone) {
  const std::string path = saved();
  const std::string without = "VK_ICD_FILENAMES=/none";
  const Outcome loaded = raystudy("tree load " + path + " --scene terrain --triangles 1000 --rays 100", without);
  const Outcome drawn = raystudy("render terrain --triangles 1000 --width 16 --height 16 --heat-map --output " + file("a.png"), without);
  EXPECT_EQ(loaded.code, 0);
  EXPECT_THAT(loaded.text, AllOf(HasSubstr("traced by    scalar: "),
                                 HasSubstr("not traced   gpu: there is no Vulkan device on this machine\n")));
  EXPECT_EQ(drawn.code, 0) << drawn.text;
}

TEST_F(Tree, WideOnesToo) {
  const std::string path = saved("--builder 'sweep-sah: {leaves: sah}' --encode 'bvh8: {boxes: 8-bit}'");
  EXPECT_THAT(raystudy("tree info " + path).text, AllOf(HasSubstr("tree         wide-bvh of 8 children a node, 8-bit boxes\n"),
                                                        HasSubstr("encoder      bvh8{boxes=8-bit, ")));
  const Outcome loaded = raystudy("tree load " + path + " --scene terrain --triangles 1000 --rays 500");
  EXPECT_EQ(loaded.code, 0);
  EXPECT_THAT(loaded.text, HasSubstr("traced by    wide: closest and any hits of 500 random rays are right\n"));
}

TEST_F(Tree, SavingMistakesAreShownAtOnce) {
  const Outcome outcome =
      raystudy("tree save terrain " + file("a.tree") + " --builder 'sweep-sah: {leafs: sah}' --optimize inserton");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.text, AllOf(HasSubstr("--builder:1:13: builder 'sweep-sah' has no parameter 'leafs'; expected one of "),
                                  HasSubstr("; did you mean 'leaves'?\n--optimize:1:1: there is no optimizer 'inserton'; "),
                                  HasSubstr("; did you mean 'insertion'?\n")));
  expect_error(fmt::format("save terrain {} --builder embree", file("a.tree")),
               "what builder 'embree' makes ('embree') cannot be saved; expected a bvh2 or a wide-bvh");
  expect_error("save terrain /proc/nowhere/a.tree", "/proc/nowhere: cannot make the folder: No such file or directory");
  expect_error(fmt::format("save terrain {} --triangles 10", file("a.tree")),
               "scene 'terrain' of 10 triangles; expected 1000 to 100000000 triangles");
  EXPECT_TRUE(folder_.names().empty());
}

TEST_F(Tree, LoadingMistakesNameTheFile) {
  const std::string path = saved();
  const Outcome other = raystudy("tree load " + path + " --scene atrium --triangles 1000");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.text,
              testing::MatchesRegex(path + ": is of scene 'terrain' of 1014 triangles .hash [0-9a-f]+.; expected scene "
                                           "'atrium' of 1002 triangles .hash [0-9a-f]+.\n"));
  expect_error("info " + file("b.tree"), file("b.tree") + ": cannot be opened: No such file or directory");
  folder_.write("b.tree", "v 0 0 0\n");
  expect_error("info " + file("b.tree"), file("b.tree") + ": is no tree file; expected one that begins with 'RAYSTREE'");
  EXPECT_EQ(raystudy("tree").code, 2);
  EXPECT_EQ(raystudy("tree load " + path).code, 2) << "without a scene";
}

}  // namespace
}  // namespace raystudy
