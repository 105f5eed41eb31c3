// What a user reads when a scene file is bad: exact texts.
#include <gtest/gtest.h>

#include <limits>

#include "harness/scene/read.h"
#include "harness/scene/test_models.h"

namespace raystudy {
namespace {

using test::error_of;

class BadInput : public ::testing::Test {
 protected:
  /// The error's text, with FILE for the path of the file.
  [[nodiscard]] std::string error(const std::string& name, std::string_view content) const {
    const std::string path = environment.folder.write(name, content);
    return shortened(error_of([&] { (void)read_scene(path); }), path);
  }
  static std::string shortened(std::string text, const std::string& path) {
    for (std::size_t at = text.find(path); at != std::string::npos; at = text.find(path)) text.replace(at, path.size(), "FILE");
    return text;
  }
  static std::string ply(const std::string& vertices_and_faces, int vertices = 3, int faces = 1) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + std::to_string(faces) +
           "\nproperty list uchar int vertex_indices\nend_header\n" + vertices_and_faces;
  }
  test::CleanEnvironment environment;
};

TEST_F(BadInput, Names) {
  const std::string folder = environment.folder.text();
  EXPECT_EQ(error_of([&] { (void)read_scene(folder + "/none.ply"); }), folder + "/none.ply: there is no such file");
  EXPECT_EQ(error_of([&] { (void)read_scene(folder + "/no/none.ply"); }),
            folder + "/no/none.ply: there is no folder '" + folder + "/no'");
  (void)error("none.obj", "x");  // leaves the file
  EXPECT_EQ(error_of([&] { (void)read_scene(folder + "/noen.obj"); }),
            folder + "/noen.obj: there is no such file; did you mean '" + folder + "/none.obj'?");
  EXPECT_EQ(error_of([&] { (void)read_scene(folder); }), folder + ": is not a regular file");
  const std::string unknown = error("a.plx", "x");
  EXPECT_TRUE(
      unknown.starts_with("FILE: no reader knows the extension 'plx'; expected one of ply, obj, stl, off, bsp, gltf, glb, "));
  EXPECT_TRUE(unknown.ends_with("; did you mean 'ply'?")) << unknown;
}

TEST_F(BadInput, PlyHeader) {
  EXPECT_EQ(error("a.ply", ""), "FILE:1: the header ends without 'end_header'; expected a complete PLY header");
  EXPECT_EQ(error("a.ply", "\xff\xfe\x80 junk\n"), "FILE:1: the file does not begin with 'ply'; expected a PLY file");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\n"),
            "FILE:4: the header ends without 'end_header'; expected a complete PLY header");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii8 1.0\nend_header\n"),
            "FILE:2: unknown format 'ascii8'; expected ascii, binary_little_endian or binary_big_endian");
  EXPECT_EQ(error("a.ply", "ply\nend_header\n"),
            "FILE:2: the header has no 'format' line; expected format ascii, binary_little_endian or binary_big_endian");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\nelement vertex many\nend_header\n"),
            "FILE:3: element 'vertex' has the count 'many'; expected a whole number");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty flaot x\nend_header\n"),
            "FILE:4: unknown property type 'flaot'; expected a PLY type; did you mean 'float'?");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty list float int x\nend_header\n"),
            "FILE:4: the list 'x' has a count of type 'float'; expected an integer type");
  EXPECT_EQ(
      error("a.ply", "ply\nformat ascii 1.0\nelemnt \xff 3\nend_header\n"),
      "FILE:3: the header line 'elemnt \\xff 3' is not understood; expected format, element, property, comment or end_header");
  EXPECT_EQ(error("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n"),
            "FILE: the vertices have no x, y and z; expected 'property float x' and so on in the header");
  EXPECT_EQ(
      error("a.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar float vertex_indices\nend_header\n3 0 0 0\n"),
      "FILE: the faces have no list of vertex indices; expected 'property list uchar int vertex_indices' in the header");
}

TEST_F(BadInput, PlyBody) {
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n")), "FILE:12:1: the file ends at vertex 2 of 3; expected a complete file");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n")), "FILE:13:1: the file ends at face 0 of 1; expected a complete file");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0,5 0\n1 1 0\n3 0 1 2\n")),
            "FILE:11:3: '0,5' stands where a number should; expected a number");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n3 0 1 x\n")),
            "FILE:13:7: 'x' stands where an index or count should; expected a whole number");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n2 0 1\n")), "FILE:13:1: face 0 has 2 corners; expected 3 or more");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n3 0 1 -2\n")),
            "FILE:13:7: face 0 refers to vertex -2; expected an index from 0 on");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n")),
            "FILE: triangle 0 refers to vertex 3; expected an index below 3");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 nan 0\n1 1 0\n3 0 1 2\n")),
            "FILE: vertex 1 is (1, nan, 0); expected finite coordinates");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 -1e99\n3 0 1 2\n")),
            "FILE: vertex 2 is (1, 1, -inf); expected finite coordinates");
  EXPECT_EQ(error("a.ply", ply("0 0 0\n1 0 0\n1 1 0\n", 3, 0)), "FILE: the scene has no triangles; expected at least one");
  EXPECT_EQ(error("a.ply", ply("", 0, 0)), "FILE: the scene has no triangles; expected at least one");
}

TEST_F(BadInput, PlyBinary) {
  const std::string good = test::square_ply_little_endian();
  EXPECT_EQ(error("a.ply", good.substr(0, good.size() - 1)), "FILE: the file ends at face 0 of 1; expected a complete file");
  EXPECT_EQ(error("a.ply", good.substr(0, good.size() - 20)), "FILE: the file ends at vertex 3 of 4; expected a complete file");
  std::string negative = good;
  negative.replace(good.size() - 4, 4, test::packed(-1));
  EXPECT_EQ(error("a.ply", negative),
            "FILE: face 0 refers to vertex -1 (before byte " + std::to_string(good.size()) + "); expected an index from 0 on");
  // A count that would need more memory than any machine has.
  std::string huge = good;
  huge.replace(huge.find("vertex 4"), 8, "vertex 999999999999");
  EXPECT_EQ(error("a.ply", huge), "FILE: the file ends at vertex 5 of 999999999999; expected a complete file");
}

TEST_F(BadInput, Obj) {
  EXPECT_EQ(error("a.obj", ""), "FILE: the scene has no triangles; expected at least one");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nv 1 0\n"), "FILE:2:6: the vertex has 2 coordinates; expected three");
  EXPECT_EQ(error("a.obj", "v 0 0 abc\n"), "FILE:1:7: 'abc' stands where a coordinate should; expected a number");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nf 1 2\n"), "FILE:2:6: the face has 2 corners; expected 3 or more");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nf 1 1 x/1\n"),
            "FILE:2:7: 'x/1' stands where a vertex index should; expected a whole number");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nf 1 0 1\n"), "FILE:2:5: the face refers to vertex 0; expected 1 to 1 or -1 to -1");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nf 1 1 -2\n"), "FILE:2:7: the face refers to vertex -2; expected 1 to 1 or -1 to -1");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nf 1 1 7\n"), "FILE: triangle 0 refers to vertex 6; expected an index below 1");
  EXPECT_EQ(error("a.obj", "v 0 0 0\nfv 1 1 1\n"),
            "FILE:2:1: unknown statement 'fv'; expected an OBJ statement such as v, f, usemtl or mtllib");
  EXPECT_EQ(
      error("a.obj", "usemlt red\n"),
      "FILE:1:1: unknown statement 'usemlt'; expected an OBJ statement such as v, f, usemtl or mtllib; did you mean 'usemtl'?");
  EXPECT_EQ(error("a.obj", "\x01\xff\n"),
            "FILE:1:1: unknown statement '\\x01\\xff'; expected an OBJ statement such as v, f, usemtl or mtllib");
  EXPECT_EQ(error("a.obj", "mtllib none.mtl\n"),
            "FILE:1:8: the material library 'none.mtl' is missing; expected that file beside the model");
  environment.folder.write("a.mtl", "newmtl red\nKd 1 0 0\n");
  EXPECT_EQ(error("a.obj", "mtllib a.mtl\nusemtl rde\n"),
            "FILE:2:8: unknown material 'rde'; expected one of the material library; did you mean 'red'?");
}

TEST_F(BadInput, Stl) {
  EXPECT_EQ(error("a.stl", "x"), "FILE: the file has 1 bytes; expected an STL file: 'solid' or a binary header of 84 bytes");
  const std::string binary = test::square_stl_binary();
  EXPECT_EQ(error("a.stl", binary.substr(0, binary.size() - 1)), "FILE: the file ends at facet 1 of 2; expected a complete file");
  EXPECT_EQ(error("a.stl", "solid x\nendsolid x\n"), "FILE: the scene has no triangles; expected at least one");
  EXPECT_EQ(error("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertx 0 0 0\n"),
            "FILE:5:1: found 'vertx'; expected 'vertex'");
  EXPECT_EQ(error("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n"),
            "FILE:4:10: 'zero' stands where a coordinate should; expected a number");
  EXPECT_EQ(error("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n"),
            "FILE:5:1: the file ends in a facet; expected 'vertex'");
  EXPECT_EQ(error("a.stl", "solid x\nloop\n"), "FILE:2:1: found 'loop'; expected 'facet', 'solid' or 'endsolid'");
}

TEST_F(BadInput, Off) {
  EXPECT_EQ(error("a.off", "ply\n"), "FILE:1:1: the file begins with 'ply'; expected OFF");
  EXPECT_EQ(error("a.off", "4OFF\n"), "FILE:1:1: the variant '4OFF' is not three-dimensional; expected OFF");
  EXPECT_EQ(error("a.off", "OFF BINARY\n"), "FILE:1:5: binary OFF is not read; expected an ASCII file");
  EXPECT_EQ(error("a.off", "OFF\nx 1 0\n"), "FILE:2:1: 'x' stands where the number of vertices should; expected a whole number");
  EXPECT_EQ(error("a.off", "OFF\n99 1 0\n0 0 0\n"),
            "FILE:2:4: 99 vertices and 1 faces do not fit into the file; expected a complete file");
  EXPECT_EQ(error("a.off", "OFF\n3 1 0\n0 0 0\n0 0 0\n"), "FILE:5:1: the file ends at vertex 2 of 3; expected a complete file");
  EXPECT_EQ(error("a.off", "OFF\n1 1 0\n0 0 q\n3 0 0 0\n"), "FILE:3:5: 'q' stands where a coordinate should; expected a number");
  EXPECT_EQ(error("a.off", "OFF\n1 2 0\n0 0 0\n3 0 0 0\n"), "FILE:5:1: the file ends at face 1 of 2; expected a complete file");
  EXPECT_EQ(error("a.off", "OFF\n1 1 0\n0 0 0\n2 0 0\n"), "FILE:4:1: face 0 has 2 corners; expected 3 or more");
  EXPECT_EQ(error("a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n"), "FILE:4:7: face 0 refers to vertex 1; expected 0 to 0");
  EXPECT_EQ(error("a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 0.5\n"),
            "FILE:4:7: '0.5' stands where a vertex index should; expected a whole number");
}

TEST_F(BadInput, Bsp) {
  const std::string good = test::small_bsp();
  EXPECT_EQ(error("a.bsp", "IBSP"), "FILE: the file has 4 bytes; expected a Quake 3 level");
  EXPECT_EQ(error("a.bsp", std::string(200, 'x')),
            "FILE: the file does not begin with 'IBSP' and version 46; expected a Quake 3 level");
  EXPECT_EQ(error("a.bsp", good.substr(0, good.size() - 1)),
            "FILE: the face table takes bytes 884 to 1092 of 1091; expected a complete file");
  const auto changed = [&good](std::size_t offset, int value) {
    std::string bad = good;
    bad.replace(offset, 4, test::packed(value));
    return bad;
  };
  const std::size_t polygon = 884;
  const std::size_t patch = polygon + 104;
  EXPECT_EQ(error("a.bsp", changed(polygon, 2)), "FILE: face 0 refers to texture 2; expected an index below 2");
  EXPECT_EQ(error("a.bsp", changed(polygon + 8, 9)), "FILE: face 0 has type 9; expected 1 to 4");
  EXPECT_EQ(error("a.bsp", changed(polygon + 12, 12)), "FILE: face 0 refers to vertex 15; expected an index below 13");
  EXPECT_EQ(error("a.bsp", changed(polygon + 24, 9)),
            "FILE: face 0 has 9 mesh vertices from 0; expected a multiple of 3 within 6");
  EXPECT_EQ(error("a.bsp", changed(860, 4)), "FILE: face 0 refers to its vertex 4; expected an index below 4");
  EXPECT_EQ(error("a.bsp", changed(patch + 96, 4)),
            "FILE: patch 1 is 4 by 3 with 9 vertices; expected odd sizes from 3 on and a vertex each");
}

TEST_F(BadInput, Gltf) {
  EXPECT_TRUE(error("a.gltf", "{").starts_with("FILE: tinygltf cannot read the file: ")) << error("a.gltf", "{");
  EXPECT_TRUE(error("a.glb", "glTF\x02").starts_with("FILE: tinygltf cannot read the file: "));
  EXPECT_EQ(error("a.gltf", R"({"asset": {"version": "2.0"}})"), "FILE: the file has no scene; expected at least one");
  EXPECT_EQ(error("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [3]}]})"),
            "FILE: the file refers to node 3; expected an index below 0");
  EXPECT_EQ(error("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"children": [0]}]})"),
            "FILE: node 0 is reached twice; expected a tree of nodes");
  EXPECT_EQ(error("a.gltf", R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]})"),
            "FILE: the file needs the extension KHR_draco_mesh_compression; expected uncompressed meshes");
  std::string chain;
  for (int node = 1; node <= 1001; ++node) chain += "{\"children\": [" + std::to_string(node) + "]}, ";
  EXPECT_EQ(error("a.gltf", R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [)" + chain + "{}]}"),
            "FILE: the nodes are nested deeper than 1000; expected a flatter tree");
  environment.folder.write("data.bin", test::small_gltf_buffer());
  EXPECT_EQ(error("a.gltf", test::small_gltf("data.bin", 4)),
            "FILE: accessor 1 with 4 elements reaches past its buffer of 42 bytes; expected a complete file");
  std::string wrong = test::small_gltf_buffer();
  wrong[40] = 5;
  environment.folder.write("data.bin", wrong);
  EXPECT_EQ(error("a.gltf", test::small_gltf("data.bin")),
            "FILE: triangle 0 refers to vertex 5 of its mesh; expected an index below 3");
}

TEST_F(BadInput, Assimp) { EXPECT_EQ(error("a.ac", "junk"), "FILE: Assimp cannot read the file: File is too small"); }

TEST_F(BadInput, Archives) {
  const std::string ply(test::square_ply);
  EXPECT_EQ(error("a.ply.gz", ply), "FILE: is not compressed data; expected gzip, xz, zstd, bzip2 or lzma");
  EXPECT_EQ(error("a.ply.xz", ""), "FILE: the packed data is damaged or cut short: the file is empty");
  using Filter = int (*)(archive*);
  const std::vector<std::pair<std::string, Filter>> filters{{"a.ply.gz", archive_write_add_filter_gzip},
                                                            {"a.ply.xz", archive_write_add_filter_xz},
                                                            {"a.ply.zst", archive_write_add_filter_zstd}};
  for (const auto& [name, filter] : filters) {
    const std::string packed = test::compressed(ply, filter);
    const std::string text = error(name, packed.substr(0, packed.size() / 2));
    EXPECT_TRUE(text.starts_with("FILE: the packed data is damaged or cut short: ")) << name << ": " << text;
  }
  EXPECT_EQ(error("a.zip", test::zipped({{"readme.txt", "x"}})), "FILE: the archive holds no file of a known scene format");
  EXPECT_EQ(error("b.zip", test::zipped({{"one.ply", ply}, {"sub/two.obj", "x"}})),
            "FILE: the archive holds 2 scene files; expected FILE/FILE with FILE one of one.ply, sub/two.obj");
  const std::string zip = environment.folder.text() + "/b.zip";
  EXPECT_EQ(error_of([&] { (void)read_scene(zip + "/sub/tow.obj"); }),
            zip + ": the archive holds no 'sub/tow.obj'; did you mean 'sub/two.obj'?");
  EXPECT_EQ(error_of([&] { (void)read_scene(zip + "/one.ply/deeper.ply"); }),
            zip + "/one.ply: is no readable archive: Unrecognized archive format");
  EXPECT_TRUE(error("c.zip", "no zip at all").starts_with("FILE: ")) << error("c.zip", "no zip at all");
}

}  // namespace
}  // namespace raystudy
