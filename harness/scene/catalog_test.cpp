#include "harness/scene/catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/scene/open.h"
#include "harness/scene/sha256.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

using test::error_of;

const std::string sha(64, 'a');

class CatalogFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] Catalog read(const std::string& yaml) const { return read_catalog(environment.folder.write("c.yaml", yaml)); }
  /// The error's lines without the file's path.
  [[nodiscard]] std::string error(const std::string& yaml) const {
    const std::string path = environment.folder.write("c.yaml", yaml);
    std::string text = error_of([&] { (void)read_catalog(path); });
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) text.erase(at, path.size() + 1);
    return text;
  }
  static std::string entry(const std::string& more) {
    return "scenes:\n  box:\n    title: Box\n    source: here\n    licence: MIT\n    triangles: 12\n    files:\n      - path: "
           "box/box.ply\n        sha256: " +
           sha + "\n" + more;
  }
  test::CleanEnvironment environment;
};

TEST_F(CatalogFileTest, SaysEverythingAboutAScene) {
  const Catalog catalog = read(entry(
      "        get: npm:box@1.0.0#a/box.ply\n    material: {kind: refractive, color: [1, 0.5, 1], refraction-index: 1.5}\n"
      "    lights:\n      - {name: sun, direction: [0, 1, 0]}\n      - {name: lamp, position: [1, 2, 3], intensity: [4, 4, 4]}\n"
      "    cameras:\n      - {name: front, eye: [0, 0, 5], target: [0, 0, 0], up: [1, 0, 0], fov: 40}\n"
      "    frames:\n      - path: box/box.f32\n        sha256: " +
      sha + "\n"));
  ASSERT_EQ(catalog.entries.size(), 1U);
  const CatalogEntry& box = *catalog.find("box");
  EXPECT_EQ(box.title, "Box");
  EXPECT_EQ(box.triangles, 12);
  EXPECT_EQ(box.files.at(0).get, "npm:box@1.0.0#a/box.ply");
  EXPECT_EQ(box.files.at(0).where.line, 8);
  EXPECT_EQ(box.material->kind, MaterialKind::refractive);
  EXPECT_EQ(box.material->refraction_index, 1.5F);
  EXPECT_TRUE(box.lights.at(0).point_at_infinity);
  EXPECT_EQ(box.lights.at(1).intensity, (Vec3{4}));
  EXPECT_EQ(box.cameras.at(0).up, (Vec3{1, 0, 0}));
  EXPECT_EQ(box.cameras.at(0).vertical_fov, 40);
  EXPECT_EQ(box.frames.size(), 1U);
  EXPECT_EQ(catalog.find("bo"), nullptr);
}

TEST_F(CatalogFileTest, EveryMistakeAtOnceWithItsPlace) {
  EXPECT_EQ(
      error("scenes:\n"
            "  box:\n"
            "    titel: Box\n"
            "    source: [1]\n"
            "    licence: MIT\n"
            "    triangles: many\n"
            "    files:\n"
            "      - {path: a.ply, sha256: 12}\n"
            "      - {path: b.ply}\n"
            "    material: {kind: diffus}\n"
            "    lights:\n"
            "      - {name: lamp}\n"
            "    cameras:\n"
            "      - {name: a, eye: [0, 0], target: [0, 0, 0]}\n"
            "      - {name: b, eye: [0, 1, 0], target: [0, 0, 0], fov: 200}\n"
            "      - {name: c, eye: [0, 1, 0], target: [0, 0, 0]}\n"
            "extra: 1\n"),
      "3:5: unknown key 'titel' in scene 'box'; expected one of by-hand, cameras, files, frames, licence, lights, material, "
      "source, title, triangles; did you mean 'title'?\n"
      "4:13: 'source' is a list; expected a text\n"
      "6:16: 'triangles' is the text 'many'; expected a whole number from 1 to 2147483647\n"
      "8:31: 'sha256' is '12'; expected 64 lower-case hex digits\n"
      "10:22: 'kind' is the text 'diffus'; expected diffuse, reflective, refractive or emitter; did you mean 'diffuse'?\n"
      "12:9: a light needs either 'position' or 'direction'\n"
      "14:24: 'eye' is a list; expected three numbers, e.g. [0, 1, 0]\n"
      "15:59: 'fov' is the integer 200; expected degrees from 1 to 170\n"
      "16:9: the camera's 'up' is along its view or its eye is its target\n"
      "3:5: scene 'box' has no 'title'\n"
      "9:9: scene 'box' has a file without 'sha256'; expected a hash, or 'by-hand' in the scene\n"
      "17:1: unknown key 'extra' in the catalog; expected one of scenes");
}

TEST_F(CatalogFileTest, OtherMistakes) {
  EXPECT_EQ(error("a: [1"), "1:1: this is no YAML: end of sequence flow not found");
  EXPECT_EQ(error("scenes: 3\n"), "1:9: 'scenes' is the integer 3; expected a map of names and scenes");
  EXPECT_EQ(error("scenes:\n  box: 3\n"), "2:8: scene 'box' is the integer 3; expected a map of keys and values");
  EXPECT_EQ(error(entry("        get: ftp://x\n")),
            "10:14: 'ftp://x' is no source; expected https://…, npm:package@version#path or deb:package#path");
  EXPECT_EQ(error(entry("        get: npm:box#a\n")),
            "10:14: 'npm:box#a' is no source; expected https://…, npm:package@version#path or deb:package#path");
  EXPECT_EQ(error(entry("      - {path: c.ply, get: 'https://x/c.ply'}\n    by-hand: put it there\n")),
            "10:9: a file with 'get' has no 'sha256'");
  EXPECT_EQ(error(entry("    title: Twice\n")),
            "10:5: key 'title' stands a second time; expected each key once; the first is on line 3");
  EXPECT_EQ(
      error("scenes:\n  box:\n    title: Box\n    source: here\n    licence: MIT\n    files: []\n"),
      "2:3: scene 'box' has no 'triangles'; expected a count, or 'by-hand'\n2:3: scene 'box' has no file; expected at least one");
  EXPECT_EQ(error(entry("    frames: []\n")), "10:13: 'frames' has no file; expected one at least, or no 'frames'");
  const std::string camera = "      - {name: a, eye: [0, 0, 1], target: [0, 0, 0]}\n";
  EXPECT_EQ(error(entry("    cameras:\n" + camera + camera)), "2:3: scene 'box' has two cameras 'a'");
}

/// A catalog of one scene whose file, of 2 triangles, is in the folder `scenes`.
class OpenScene : public ::testing::Test {
 protected:
  OpenScene() { environment.folder.write("scenes/square/square.ply", test::square_ply); }
  void write_catalog(const std::string& sha256, int triangles, const std::string& more = "") {
    environment.folder.write(
        "c.yaml", "scenes:\n  my-square:\n    title: Square\n    source: here\n    licence: MIT\n    triangles: " +
                      std::to_string(triangles) + "\n    files:\n      - path: square/square.ply\n        sha256: " + sha256 +
                      "\n" + more);
  }
  const std::string good = sha256_hex(test::square_ply);
  test::CleanEnvironment environment;
  test::ScopedVariable catalog{"RAYSTUDY_CATALOG", environment.folder.text() + "/c.yaml"};
  test::ScopedVariable scenes{"RAYSTUDY_SCENES", environment.folder.text() + "/none:" + environment.folder.text() + "/scenes"};
};

TEST_F(OpenScene, AddsWhatTheCatalogSays) {
  write_catalog(good, 2,
                "    material: {kind: reflective, color: [1, 1, 1]}\n    cameras:\n      - {name: top, eye: [0.5, 0.5, 3], "
                "target: [0.5, 0.5, 0]}\n"
                "    lights:\n      - {name: lamp, position: [0, 0, 3]}\n");
  const Scene scene = open_scene("my-square");
  EXPECT_EQ(scene.name, "my-square");
  EXPECT_FALSE(why_not_installed(read_catalog(catalog_path()), "my-square"));
  EXPECT_EQ(scene.camera("").name, "top");
  EXPECT_EQ(scene.lights.at(0).name, "lamp");
  EXPECT_EQ(scene.material_of(1).kind, MaterialKind::reflective);
  EXPECT_EQ(error_of([&] { (void)scene.camera("tob"); }),
            "scene 'my-square' has no camera 'tob'; expected one of top; did you mean 'top'?");
}

TEST_F(OpenScene, RefusesAnotherFileThanTheCatalogDescribes) {
  const std::string file = environment.folder.text() + "/scenes/square/square.ply";
  const std::string yaml = environment.folder.text() + "/c.yaml";
  write_catalog(sha, 2);
  EXPECT_EQ(error_of([] { (void)open_scene("my-square"); }), file + ": the SHA-256 is " + good +
                                                                 ": the file is damaged or another version; expected " + sha +
                                                                 ", as " + yaml + ":8:9 says");
  write_catalog(good, 3);
  EXPECT_EQ(error_of([] { (void)open_scene("my-square"); }),
            file + ": scene 'my-square' has 2 triangles; expected 3, as " + yaml + ":2:3 says");
}

TEST_F(OpenScene, NamesNobodyKnowsAndScenesNobodyHas) {
  write_catalog(
      good, 2,
      "  far:\n    title: Far\n    source: there\n    licence: MIT\n    triangles: 1\n    files:\n      - path: far/far.ply\n    "
      "    sha256: " +
          sha +
          "\n        get: https://far.example/far.ply\n  other:\n    title: Other\n    source: there\n    licence: MIT\n"
          "    by-hand: ask the author for other/other.ply\n    files:\n      - {path: other/other.ply}\n"
          "  bare:\n    title: Bare\n    source: there\n    licence: MIT\n    triangles: 1\n    files:\n      - path: bare.ply\n "
          "       sha256: " +
          sha + "\n");
  EXPECT_EQ(error_of([] { (void)open_scene("my-sqaure"); }),
            "there is no scene 'my-sqaure'; expected a name that 'raystudy scene list' shows; did you mean 'my-square'?");
  EXPECT_EQ(error_of([] { (void)open_scene("sopu"); }),
            "there is no scene 'sopu'; expected a name that 'raystudy scene list' shows; did you mean 'soup'?");
  const auto missing = [](const char* name) -> std::string {
    try {
      (void)open_scene(name);
    } catch (const SceneNotInstalled& error) {
      return error.what();
    }
    return "no SceneNotInstalled";
  };
  const Catalog known = read_catalog(catalog_path());
  for (const char* name : {"far", "other", "bare"}) EXPECT_EQ(why_not_installed(known, name), missing(name));
  for (const char* name : {"my-square", "atrium", "some/file.ply"}) EXPECT_FALSE(why_not_installed(known, name)) << name;
  EXPECT_EQ(missing("far"), "scene not installed: raystudy scene get far");
  EXPECT_EQ(missing("other"), "scene not installed: other; ask the author for other/other.ply");
  EXPECT_EQ(missing("bare"), "scene not installed: bare; put the file at bare.ply below a folder of RAYSTUDY_SCENES");
}

TEST_F(OpenScene, FramesNobodyHas) {
  const auto missing = [this](const std::string& more) {
    write_catalog(good, 2,
                  "    frames:\n      - {path: square/square.ply, sha256: " + good +
                      "}\n      - {path: square/lost.ply, sha256: " + sha + more);
    const std::string why = why_not_installed(read_catalog(catalog_path()), "my-square").value_or("installed");
    EXPECT_EQ(test::error_of([] { (void)open_scene("my-square"); }), why);
    return why;
  };
  EXPECT_EQ(missing("}\n"),
            "scene not installed: my-square lacks file 2 of 2 with frames, square/lost.ply; put the file at square/lost.ply "
            "below a folder of RAYSTUDY_SCENES");
  EXPECT_EQ(missing("}\n    by-hand: ask the author\n"),
            "scene not installed: my-square lacks file 2 of 2 with frames, square/lost.ply; ask the author");
  EXPECT_EQ(missing(", get: 'https://far.example/lost.ply'}\n"), "scene not installed: raystudy scene get my-square");
}

TEST_F(OpenScene, APathIsReadAsItIs) {
  EXPECT_EQ(open_scene(environment.folder.text() + "/scenes/square/square.ply").triangles.size(), 2U);
}

TEST_F(OpenScene, ByHandScenesAreTakenAsTheyAre) {
  write_catalog(good, 2,
                "  other:\n    title: Other\n    source: there\n    licence: MIT\n    by-hand: ask the author\n    files:\n      "
                "- {path: square/square.ply}\n");
  EXPECT_EQ(open_scene("other").triangles.size(), 2U);
}

// The project's own catalog.
TEST(OurCatalog, EveryInstallableSceneHasTwoCamerasALightAndAHash) {
  const Catalog catalog = read_catalog(RAYSTUDY_SOURCE_DIR "/scenes/catalog.yaml");
  EXPECT_GE(catalog.entries.size(), 30U);
  for (const CatalogEntry& entry : catalog.entries) {
    if (!entry.by_hand.empty()) continue;
    EXPECT_GE(entry.cameras.size(), 2U) << entry.name;
    EXPECT_GE(entry.lights.size(), 1U) << entry.name;
    EXPECT_GT(entry.triangles, 0) << entry.name;
  }
}

TEST(OurCatalog, ScenesAtHandAreWhatItSays) {
  const Catalog catalog = read_catalog(RAYSTUDY_SOURCE_DIR "/scenes/catalog.yaml");
  const test::ScopedVariable file("RAYSTUDY_CATALOG", catalog.file);
  int opened = 0;
  for (const CatalogEntry& entry : catalog.entries) {
    if (installed_file(entry) == nullptr) continue;
    const Scene scene = open_scene(entry.name);  // compares hash and count
    ++opened;
    for (const Camera& camera : scene.cameras) {
      // A camera outside the scene must at least look at it.
      Box near = scene.bounds;
      near.extend(near.lower - near.extent() * 0.1F);
      near.extend(near.upper + near.extent() * 0.1F);
      EXPECT_TRUE(near.contains(Box{camera.eye, camera.eye}) || near.contains(Box{camera.target, camera.target}))
          << entry.name << ' ' << camera.name;
    }
  }
  if (opened == 0) GTEST_SKIP() << "no scene of the catalog is at hand";
}

}  // namespace
}  // namespace raystudy
