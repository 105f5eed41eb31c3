#include "harness/scene/parsed_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>

#include "harness/scene/load.h"
#include "harness/scene/read.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

using ::testing::internal::CaptureStderr;
using ::testing::internal::GetCapturedStderr;

/// A grid of n by n cells, large enough to be worth caching from n = 60 on.
std::string grid_obj(int n, const std::string& first_line = "") {
  std::string obj = first_line;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) obj += "v " + std::to_string(x) + " " + std::to_string(y) + " 0.125\n";
  }
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1;
      obj += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + n + 2) + " " +
             std::to_string(a + n + 1) + "\n";
    }
  }
  return obj;
}

class ParsedCache : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> cached() const {
    std::vector<std::string> files;
    for (const std::string& name : environment.folder.names()) {
      if (name.starts_with("cache/")) files.push_back(environment.folder.text() + "/" + name);
    }
    return files;
  }
  /// Reads the scene, returns what was printed.
  static std::string printed(const std::string& file) {
    CaptureStderr();
    (void)read_scene(file);
    return GetCapturedStderr();
  }
  test::CleanEnvironment environment;
};

TEST_F(ParsedCache, GivesBackTheWholeScene) {
  environment.folder.write("a.mtl", "newmtl lamp\nKe 3 2 1\n");
  const std::string file = environment.folder.write("grid.obj", grid_obj(60, "mtllib a.mtl\nusemtl lamp\n"));
  const Scene parsed = read_scene(file);
  ASSERT_EQ(cached().size(), 1U);
  const Scene mapped = read_scene(file);
  EXPECT_NE(mapped.vertices.data(), parsed.vertices.data());
  EXPECT_EQ(mapped.name, "grid");
  EXPECT_EQ(mapped.hash, parsed.hash);
  EXPECT_EQ(mapped.bounds, parsed.bounds);
  EXPECT_TRUE(std::equal(mapped.vertices.begin(), mapped.vertices.end(), parsed.vertices.begin(), parsed.vertices.end()));
  EXPECT_TRUE(std::equal(mapped.triangles.begin(), mapped.triangles.end(), parsed.triangles.begin(), parsed.triangles.end()));
  EXPECT_EQ(mapped.material_of(0).emission, (Vec3{3, 2, 1}));
  EXPECT_EQ(mapped.cameras.at(0).name, "overview");
  EXPECT_EQ(mapped.cameras.at(0).eye, parsed.cameras.at(0).eye);
  EXPECT_EQ(mapped.lights.at(0).point_at_infinity, true);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped.vertices.data()) % 64, 0U);
}

TEST_F(ParsedCache, KeepsFrames) {
  const std::string model = environment.folder.write("grid.obj", grid_obj(60));
  const std::size_t vertices = 61 * 61;
  std::string sequence;
  for (std::size_t i = 0; i < 2 * vertices * 3; ++i) sequence += test::packed(static_cast<float>(i));
  const std::string frames = environment.folder.write("grid.f32", sequence);
  for (int pass = 0; pass < 2; ++pass) {
    const Scene scene = load_scene({model}, {{frames}});
    ASSERT_EQ(scene.frames.size(), 2U);
    EXPECT_EQ(scene.frames[0][0], (Vec3{0, 1, 2}));
    EXPECT_EQ(scene.frames[1][vertices - 1].z, static_cast<float>(2 * vertices * 3 - 1));
  }
  EXPECT_EQ(load_scene({model}).frames.size(), 0U);
  EXPECT_EQ(load_scene({model}, {{model}, {model}, {model}}).frames.size(), 3U);
}

TEST_F(ParsedCache, ChangedFilesAreParsedAgain) {
  environment.folder.write("a.mtl", "newmtl lamp\nKe 3 2 1\n");
  const std::string file = environment.folder.write("grid.obj", grid_obj(60, "mtllib a.mtl\nusemtl lamp\n"));
  (void)read_scene(file);
  environment.folder.write("a.mtl", "newmtl lamp\nKe 7 2 1\n");
  EXPECT_EQ(read_scene(file).material_of(0).emission.x, 7);
  environment.folder.write("grid.obj", grid_obj(61, "mtllib a.mtl\nusemtl lamp\n"));
  EXPECT_EQ(read_scene(file).triangles.size(), 2U * 61 * 61);
}

TEST_F(ParsedCache, DamageIsFoundReportedAndMended) {
  const std::string file = environment.folder.write("grid.obj", grid_obj(60));
  const std::string hash = read_scene(file).hash;
  const std::string cache = cached().at(0);
  const auto size = std::filesystem::file_size(cache);
  const auto expect_mended = [&](const std::string& reason) {
    EXPECT_EQ(printed(file),
              "warning: " + cache + ": the cached scene is not usable (" + reason + "); parsing " + file + " again\n");
    EXPECT_EQ(printed(file), "");
    EXPECT_EQ(read_scene(file).hash, hash);
  };
  const auto flip = [&cache](std::size_t offset) {
    std::fstream stream(cache, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekg(static_cast<std::streamoff>(offset));
    const char old = static_cast<char>(stream.get());
    stream.seekp(static_cast<std::streamoff>(offset));
    stream.put(static_cast<char>(old ^ 1));
  };
  flip(0);
  expect_mended("it does not begin as one");
  flip(16);
  expect_mended("its header is damaged");
  flip(size / 2);
  expect_mended("its content is damaged");
  std::filesystem::resize_file(cache, size - 1);
  expect_mended("it has " + std::to_string(size - 1) + " bytes instead of " + std::to_string(size));
  std::filesystem::resize_file(cache, 20);
  expect_mended("it is shorter than its header");
}

TEST_F(ParsedCache, WithoutAFolderThereIsOneWarning) {
  // The cache's folder is a file: nobody can make a folder in it, not even root.
  environment.folder.write("cache", "in the way");
  const std::string first = environment.folder.write("a.obj", grid_obj(60));
  const std::string second = environment.folder.write("b.obj", grid_obj(62));
  const std::string text = printed(first) + printed(second);
  EXPECT_EQ(text, "warning: parsed scenes are not cached: " + environment.folder.text() +
                      "/cache/raystudy/parsed cannot be written: Not a directory\n");
}

TEST_F(ParsedCache, ArchivesAreCachedToo) {
  const std::string zip = environment.folder.write(
      "grid.zip", test::zipped({{"a.obj", grid_obj(150, "mtllib a.mtl\nusemtl x\n")}, {"a.mtl", "newmtl x\n"}}));
  const std::string hash = read_scene(zip).hash;
  ASSERT_EQ(cached().size(), 1U);
  const auto before = std::filesystem::last_write_time(cached().at(0));
  EXPECT_EQ(read_scene(zip).hash, hash);
  EXPECT_EQ(std::filesystem::last_write_time(cached().at(0)), before);
}

}  // namespace
}  // namespace raystudy
