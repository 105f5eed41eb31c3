#include "harness/scene/read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

using test::CleanEnvironment;
using ::testing::ElementsAre;

std::vector<std::vector<float>> positions(const Scene& scene) {
  std::vector<std::vector<float>> all;
  for (const Vec3 v : scene.vertices) all.push_back({v.x, v.y, v.z});
  return all;
}
std::vector<std::vector<std::uint32_t>> corners(const Scene& scene) {
  std::vector<std::vector<std::uint32_t>> all;
  for (const Triangle& t : scene.triangles) all.push_back({t[0], t[1], t[2]});
  return all;
}

class Read : public ::testing::Test {
 protected:
  [[nodiscard]] Scene read(const std::string& name, std::string_view content) const {
    return read_scene(environment.folder.write(name, content));
  }
  void expect_square(const std::string& name, std::string_view content) const {
    const Scene scene = read(name, content);
    using V = std::vector<float>;
    using T = std::vector<std::uint32_t>;
    EXPECT_THAT(positions(scene), ElementsAre(V{0, 0, 0}, V{1, 0, 0}, V{1, 1, 0}, V{0, 1, 0})) << name;
    EXPECT_THAT(corners(scene), ElementsAre(T{0, 1, 2}, T{0, 2, 3})) << name;
    EXPECT_EQ(scene.name, "square");
  }
  CleanEnvironment environment;
};

TEST_F(Read, TheSameSquareFromEveryFormat) {
  expect_square("square.ply", test::square_ply);
  expect_square("square.obj", test::square_obj());
  expect_square("square.off", test::square_off());
  expect_square("square.stl", test::square_stl_ascii());
  expect_square("b/square.stl", test::square_stl_binary());
  expect_square("square.ac", test::square_ac());
}

TEST_F(Read, PlyOfEveryEncodingAndType) {
  expect_square("le/square.ply", test::square_ply_little_endian());
  expect_square("be/square.ply", test::ply_header("binary_big_endian", "double") +
                                     test::packed_big_endian(0., 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.) +
                                     test::packed(std::uint8_t{4}) + test::packed_big_endian(0, 1, 2, 3));
  std::string coloured =
      test::ply_header("binary_little_endian", "float", "property uchar red\nproperty list uchar short weights\n");
  for (const auto& [x, y] : {std::pair{0.F, 0.F}, {1.F, 0.F}, {1.F, 1.F}, {0.F, 1.F}}) {
    coloured += test::packed(x, y, 0.F) + test::packed(std::uint8_t{7}, std::uint8_t{2}, std::int16_t{1}, std::int16_t{-1});
  }
  expect_square("colours/square.ply", coloured + test::packed(std::uint8_t{4}) + test::packed(0, 1, 2, 3));
}

TEST_F(Read, PlyFacesMayComeFirstAndOtherElementsAreSkipped) {
  expect_square("square.ply",
                "ply\r\nformat ascii 1.0\r\nelement face 1\r\nproperty list uchar int vertex_index\r\nelement camera 2\r\n"
                "property float a\r\nproperty list uchar int b\r\nelement vertex 4\r\nproperty double z\r\nproperty double x\r\n"
                "property double y\r\nend_header\r\n4 0 1 2 3\r\n0.5 2 8 9\r\n1.5 0\r\n0 0 0\r\n0 1 0\r\n0 1 1\r\n0 0 1\r\n");
}

TEST_F(Read, ZeroAreaTrianglesAreKept) {
  const Scene scene = read("flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 1 2\nf 3 3 3\n");
  EXPECT_EQ(scene.triangles.size(), 3U);
  EXPECT_EQ(scene.triangles[2], (Triangle{{2, 2, 2}}));
}

TEST_F(Read, ObjIndicesOfEveryFormAndContinuedLines) {
  expect_square("square.obj",
                "v 0 0 0 1.0\nv +1 0 0\nvt 0 0\nvn 0 0 1\nv 1 1 0\nv 0 1 0\ng wall\nf 1/1/1 2//1 3/1\nf -4 \\\n  -2 -1\n");
}

TEST_F(Read, ObjMaterialsByMtl) {
  environment.folder.write(
      "m/box.mtl",
      "newmtl red\nKd 1 0 0\n\nnewmtl lamp\nKd 1 1 1\nKe 5 4 3\n\nnewmtl glass\nillum 7\nNi 1.5\nTf 0.9 0.9 1\n\n"
      "newmtl mirror\nillum 3\nKs 0.8 0.8 0.8\n");
  const Scene scene = read("m/box.obj",
                           "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nusemtl red\nf 1 2 3\nusemtl lamp\nf 1 2 3\n"
                           "usemtl glass\nf 1 2 3\nusemtl mirror\nf 1 2 3\nusemtl red\nf 1 2 3\n");
  ASSERT_EQ(scene.materials.size(), 5U);
  EXPECT_THAT(std::vector<std::uint32_t>(scene.triangle_materials.begin(), scene.triangle_materials.end()),
              ElementsAre(0, 1, 2, 3, 4, 1));
  EXPECT_EQ(scene.material_of(0).name, "default");
  EXPECT_EQ(scene.material_of(1).color, (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.material_of(2).kind, MaterialKind::emitter);
  EXPECT_EQ(scene.material_of(2).emission, (Vec3{5, 4, 3}));
  EXPECT_EQ(scene.material_of(3).kind, MaterialKind::refractive);
  EXPECT_EQ(scene.material_of(3).refraction_index, 1.5F);
  EXPECT_EQ(scene.material_of(4).kind, MaterialKind::reflective);
  EXPECT_EQ(scene.material_of(4).color, (Vec3{0.8F}));
}

TEST_F(Read, GltfNodesCamerasAndMaterials) {
  environment.folder.write("g/data.bin", test::small_gltf_buffer());
  const Scene scene = read("g/scene.gltf", test::small_gltf("data.bin"));
  ASSERT_EQ(scene.triangles.size(), 1U);
  // (1, 0, 0): scaled to (2, 0, 0), turned to (0, 2, 0), moved to (10, 2, 0).
  EXPECT_NEAR(scene.vertices[1].x, 10, 1e-6);
  EXPECT_NEAR(scene.vertices[1].y, 2, 1e-6);
  EXPECT_NEAR(scene.vertices[2].x, 8, 1e-6);
  const Camera& eye = scene.camera("eye");
  EXPECT_EQ(eye.eye, (Vec3{0, 0, 5}));
  EXPECT_EQ(eye.target, (Vec3{0, 0, 4}));
  EXPECT_NEAR(eye.vertical_fov, 60, 1e-4);
  EXPECT_EQ(scene.material_of(0).name, "lamp");
  EXPECT_EQ(scene.material_of(0).kind, MaterialKind::emitter);
  EXPECT_EQ(scene.material_of(0).emission, (Vec3{4, 2, 1}));
  EXPECT_EQ(scene.materials[0].kind, MaterialKind::diffuse);
  EXPECT_EQ(scene.materials[2].kind, MaterialKind::refractive);
  EXPECT_FLOAT_EQ(scene.materials[2].refraction_index, 1.33F);
  EXPECT_EQ(scene.materials[3].kind, MaterialKind::reflective);
}

TEST_F(Read, GlbIsTheSameAsGltf) {
  std::string json = test::small_gltf("data.bin");
  json.replace(json.find(R"("uri": "data.bin", )"), std::string_view(R"("uri": "data.bin", )").size(), "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string data = test::small_gltf_buffer();
  data.resize(44, '\0');
  const auto size = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
  const std::string glb = "glTF" + test::packed(2U, size(12 + 8 + json.size() + 8 + data.size()), size(json.size())) + "JSON" +
                          json + test::packed(size(data.size())) + std::string("BIN\0", 4) + data;
  environment.folder.write("g/data.bin", test::small_gltf_buffer());
  EXPECT_EQ(read("g/b.glb", glb).hash, read("g/a.gltf", test::small_gltf("data.bin")).hash);
}

TEST_F(Read, BspPatchesAreCutEightByEight) {
  const Scene scene = read("level.bsp", test::small_bsp());
  EXPECT_EQ(scene.vertices.size(), 4U + 81U);
  ASSERT_EQ(scene.triangles.size(), 128U + 2U);
  EXPECT_EQ(scene.materials[scene.triangle_materials[0]].name, "curve");
  EXPECT_EQ(scene.materials[scene.triangle_materials[129]].name, "wall");
  EXPECT_EQ(scene.triangles[128], (Triangle{{0, 1, 2}}));
  EXPECT_EQ(scene.triangles[0], (Triangle{{4, 13, 5}}));
  // The middle of the surface: weights 1/4, 1/2, 1/4 twice, so z = 1 + 2 · 1/4.
  EXPECT_EQ(scene.vertices[4 + 4 * 9 + 4], (Vec3{1, 1, 1.5F}));
  EXPECT_EQ(scene.vertices[4 + 80], (Vec3{2, 2, 1}));
}

}  // namespace
}  // namespace raystudy
