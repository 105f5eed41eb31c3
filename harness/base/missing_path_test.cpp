#include "harness/base/missing_path.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace raystudy {
namespace {

namespace fs = std::filesystem;

class MissingPathTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / fmt::format("missing-path-{}", getpid());  // tests run side by side
    fs::create_directories(folder / "experiments" / "figures.yaml");
    for (const char* name : {"figure1.yaml", "figure2.yaml", "figures.txt"}) std::ofstream(folder / "experiments" / name) << "x";
  }
  void TearDown() override { fs::remove_all(folder); }
  [[nodiscard]] MissingPath look(const std::string& path, const std::vector<std::string_view>& extensions = {}) const {
    return look_around(folder / path, extensions);
  }
  fs::path folder;
};

TEST_F(MissingPathTest, NamesTheNearestFileOfAnExtension) {
  EXPECT_EQ(look("experiments/fgiure2.yaml", {".yaml"}).nearest, folder / "experiments/figure2.yaml");
  EXPECT_EQ(look("experiments/figures.yml", {".yaml"}).nearest, folder / "experiments/figure1.yaml")
      << "a folder is no file, and the first of two equally near is taken";
  EXPECT_EQ(look("experiments/figures.tex").nearest, folder / "experiments/figures.txt");
  EXPECT_EQ(look("experiments/quickstart.yaml", {".yaml"}).nearest, "");
  EXPECT_EQ(look("experiments/fgiure2.yaml").absent_folder, "");
}

TEST_F(MissingPathTest, NamesTheFirstFolderThatIsNotThere) {
  const MissingPath missing = look("expermients/deep/figure1.yaml", {".yaml"});
  EXPECT_EQ(missing.absent_folder, folder / "expermients");
  EXPECT_EQ(missing.nearest, folder / "experiments");
  EXPECT_EQ(look("nowhere/figure1.yaml").nearest, "");
}

TEST_F(MissingPathTest, APathWithoutAFolderIsLookedForHere) {
  const fs::path before = fs::current_path();
  fs::current_path(folder / "experiments");
  const MissingPath missing = look_around("figure3.yaml");
  fs::current_path(before);
  EXPECT_EQ(missing.absent_folder, "");
  EXPECT_EQ(missing.nearest, "figure1.yaml");
}

}  // namespace
}  // namespace raystudy
