#pragma once

#include <string>

#include "harness/scene/test_files.h"

namespace raystudy::test {

/// The square in other forms than square_ply.
inline std::string square_obj() { return "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"; }
inline std::string square_off() { return "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"; }

inline std::string square_stl_ascii() {
  return "solid square\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n"
         "endsolid square\n";
}

inline std::string square_stl_binary() {
  std::string stl(80, ' ');
  stl += packed(std::uint32_t{2});
  const auto corner = [](float x, float y) { return packed(x, y, -0.0F); };  // -0 welds with 0
  stl += packed(0.0F, 0.0F, 1.0F) + corner(0, 0) + corner(1, 0) + corner(1, 1) + packed(std::uint16_t{0});
  stl += packed(0.0F, 0.0F, 1.0F) + packed(-0.0F, 0.0F, 0.0F) + corner(1, 1) + corner(0, 1) + packed(std::uint16_t{0});
  return stl;
}

/// AC3D, which Assimp reads.
inline std::string square_ac() {
  return "AC3Db\nMATERIAL \"grey\" rgb 0.5 0.5 0.5 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
         "OBJECT world\nkids 1\nOBJECT poly\nname \"square\"\nnumvert 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
         "numsurf 1\nSURF 0x20\nmat 0\nrefs 4\n0 0 0\n1 0 0\n2 0 0\n3 0 0\nkids 0\n";
}

inline std::string ply_header(std::string_view format, std::string_view real, std::string_view extra_vertex = "") {
  const std::string type(real);
  return "ply\nformat " + std::string(format) + " 1.0\ncomment made by a test\nelement vertex 4\nproperty " + type +
         " x\nproperty " + type + " y\nproperty " + type + " z\n" + std::string(extra_vertex) +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
}

/// One quadrangle.
inline std::string square_ply_little_endian() {
  return ply_header("binary_little_endian", "float") + packed(0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, 0.F, 0.F, 1.F, 0.F) +
         packed(std::uint8_t{4}) + packed(0, 1, 2, 3);
}

/// A level with one polygon of two triangles and one patch over 3 by 3 control points, flat but for its middle, at z = 1.
inline std::string small_bsp() {
  const auto vertex = [](float x, float y, float z) { return packed(x, y, z) + std::string(32, '\0'); };
  std::string textures(144, '\0');
  textures.replace(0, 4, "wall");
  textures.replace(72, 5, "curve");
  std::string vertices = vertex(0, 0, 0) + vertex(1, 0, 0) + vertex(1, 1, 0) + vertex(0, 1, 0);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) vertices += vertex(static_cast<float>(x), static_cast<float>(y), x == 1 && y == 1 ? 3.0F : 1.0F);
  }
  const std::string mesh_vertices = packed(0, 1, 2, 0, 2, 3);
  const auto face = [](int texture, int type, int first, int count, int mesh_first, int mesh_count, int width, int height) {
    return packed(texture, -1, type, first, count, mesh_first, mesh_count) + std::string(68, '\0') + packed(width, height);
  };
  const std::string faces = face(0, 1, 0, 4, 0, 6, 0, 0) + face(1, 2, 4, 9, 0, 0, 3, 3);
  std::string header = "IBSP" + packed(46);
  std::string body;
  for (int lump = 0; lump < 17; ++lump) {
    const std::string* content = lump == 1    ? &textures
                                 : lump == 10 ? &vertices
                                 : lump == 11 ? &mesh_vertices
                                 : lump == 13 ? &faces
                                              : nullptr;
    const std::string data = content == nullptr ? "" : *content;
    header += packed(static_cast<std::int32_t>(144 + body.size()), static_cast<std::int32_t>(data.size()));
    body += data;
  }
  return header + body;
}

/// A triangle of 36 + 6 bytes in the buffer `uri`, under a node that scales by 2, turns 90° about z and moves by (10, 0, 0); a
/// camera at (0, 0, 5); three more materials.
inline std::string small_gltf(const std::string& uri, int index_count = 3) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
"nodes": [{"mesh": 0, "scale": [2, 2, 2], "rotation": [0, 0, 0.70710678118654752, 0.70710678118654752], "translation": [10, 0, 0]},
          {"name": "eye", "camera": 0, "translation": [0, 0, 5]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 1}]}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 1.0471975511965976, "znear": 0.1}}],
"materials": [{"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}},
  {"name": "lamp", "emissiveFactor": [1, 0.5, 0.25], "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}},
  {"name": "glass", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.33}}},
  {"name": "mirror", "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": 0}}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
  {"bufferView": 1, "componentType": 5123, "count": )" +
         std::to_string(index_count) + R"(, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
"buffers": [{"uri": ")" +
         uri + R"(", "byteLength": 42}]})";
}
inline std::string small_gltf_buffer() {
  return packed(0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F) + packed(std::uint16_t{0}, std::uint16_t{1}, std::uint16_t{2});
}

/// A triangle that moves and one that changes its shape.
inline std::string small_aff() {
  return R"(a 0 4 5
x thing { p 3  0 0 0  1 0 0  0 1 0 }
k thing { transl 4  0 0 0 0 0 0 0  1 0 0 0 0 0 0  3 4 0 0 0 0 0  4 7 0 0 0 0 0
  rot 4  0 0 0 1 0 0 0 0  1 0 0 1 0 0 0 0  3 0 0 1 90 0 0 0  4 0 0 1 90 0 0 0 }
tpa 2 1  0 0 0 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1 3  0 0 2 0 0 1  1 0 0 0 0 1  0 1 0 0 0 1
)";
}

/// The triangle of small_gltf_buffer with a skin of one joint and a morph target, both animated.
inline std::string animated_gltf() {
  return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "skin": 0}, {"translation": [1, 2, 3]}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}, "targets": [{"POSITION": 0}]}], "weights": [1]}],
"skins": [{"joints": [1]}],
"animations": [{"samplers": [{"input": 3, "output": 4}, {"input": 3, "output": 3, "interpolation": "STEP"}],
  "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}, {"sampler": 1, "target": {"node": 0, "path": "weights"}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
  {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
  {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
  {"bufferView": 3, "componentType": 5121, "count": 2, "type": "SCALAR"},
  {"bufferView": 4, "componentType": 5121, "count": 2, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 1, "byteLength": 12}, {"buffer": 2, "byteLength": 12},
  {"buffer": 3, "byteLength": 2}, {"buffer": 3, "byteLength": 6}],
"buffers": [{"uri": "data.bin", "byteLength": 42},
  {"uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAA", "byteLength": 12},
  {"uri": "data:application/octet-stream;base64,/wAAAP8AAAD/AAAA", "byteLength": 12},
  {"uri": "data:application/octet-stream;base64,AAECAwQF", "byteLength": 6}]})";
}

}  // namespace raystudy::test
