// Quake 3 levels (IBSP version 46), read here because Assimp takes them only inside a .pk3 and leaves out the curved patches.
// Every polygon, mesh and patch of every model of the level becomes triangles; billboards have none. A patch is a grid of
// quadratic Bezier surfaces, each cut 8 by 8. Vertices: those of polygons and meshes face by face, then the grids. Triangles: the
// grids, then polygons and meshes.
#include <fmt/format.h>

#include <array>
#include <cstring>

#include "harness/scene/source.h"

namespace raystudy {
namespace {

enum Lump : std::size_t { textures = 1, vertices = 10, mesh_vertices = 11, faces = 13 };

struct LumpEntry {
  std::uint32_t offset;
  std::uint32_t length;
};

struct Header {
  std::array<char, 4> magic;
  std::uint32_t version;
  std::array<LumpEntry, 17> lumps;
};

struct TextureRecord {
  std::array<char, 64> name;
  std::array<std::uint32_t, 2> flags;
};
static_assert(sizeof(TextureRecord) == 72);

struct VertexRecord {
  Vec3 position;
  std::array<std::uint32_t, 8> rest;  // texture and light-map coordinates, normal, colour
};
static_assert(sizeof(VertexRecord) == 44);

struct FaceRecord {
  std::uint32_t texture;
  std::uint32_t effect;
  std::uint32_t type;  // 1 polygon, 2 patch, 3 mesh, 4 billboard
  std::uint32_t first_vertex;
  std::uint32_t vertex_count;
  std::uint32_t first_mesh_vertex;
  std::uint32_t mesh_vertex_count;
  std::array<std::uint32_t, 17> light_map;
  std::array<std::uint32_t, 2> patch_size;
};
static_assert(sizeof(FaceRecord) == 104);

constexpr std::uint32_t cuts = 8;

class BspReader {
 public:
  explicit BspReader(const SourceFile& source) : source_(source) {
    Header header{};
    if (source.bytes.size() < sizeof header) fail(fmt::format("the file has {} bytes", source.bytes.size()), "a Quake 3 level");
    std::memcpy(&header, source.bytes.data(), sizeof header);
    if (std::string_view(header.magic.data(), 4) != "IBSP" || header.version != 46) {
      fail("the file does not begin with 'IBSP' and version 46", "a Quake 3 level");
    }
    textures_ = lump<TextureRecord>(header, Lump::textures, "texture");
    vertices_ = lump<VertexRecord>(header, Lump::vertices, "vertex");
    mesh_vertices_ = lump<std::uint32_t>(header, Lump::mesh_vertices, "mesh vertex");
    faces_ = lump<FaceRecord>(header, Lump::faces, "face");
  }

  Scene read() {
    for (std::size_t f = 0; f < faces_.size(); ++f) check(f);
    std::vector<std::uint32_t> first(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (!is_mesh(faces_[f])) continue;
      first[f] = static_cast<std::uint32_t>(positions_.size());
      for (std::uint32_t i = 0; i < faces_[f].vertex_count; ++i) {
        positions_.push_back(vertices_[faces_[f].first_vertex + i].position);
      }
    }
    for (const FaceRecord& face : faces_) {
      if (face.type == 2) add_patch(face);
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (is_mesh(faces_[f])) add_mesh(faces_[f], first[f]);
    }
    return finished();
  }

 private:
  [[noreturn]] void fail(std::string message, std::string expected) const {
    fail_at(source_.name, std::move(message), std::move(expected));
  }
  static bool is_mesh(const FaceRecord& face) { return face.type == 1 || face.type == 3; }

  template <class T>
  [[nodiscard]] std::vector<T> lump(const Header& header, std::size_t which, std::string_view name) const {
    const LumpEntry entry = header.lumps[which];
    const std::size_t size = source_.bytes.size();
    if (entry.offset > size || entry.length > size - entry.offset || entry.length % sizeof(T) != 0) {
      fail(fmt::format("the {} table takes bytes {} to {} of {}", name, entry.offset, std::size_t{entry.offset} + entry.length,
                       size),
           "a complete file");
    }
    std::vector<T> records(entry.length / sizeof(T));
    if (!records.empty()) std::memcpy(records.data(), source_.bytes.data() + entry.offset, entry.length);
    return records;
  }

  static bool within(std::uint32_t first, std::uint32_t count, std::size_t size) {
    return first <= size && count <= size - first;
  }

  void check(std::size_t f) const {
    const FaceRecord& face = faces_[f];
    if (face.type == 4) return;
    const auto [width, height] = face.patch_size;
    if (face.type < 1 || face.type > 4) fail(fmt::format("face {} has type {}", f, face.type), "1 to 4");
    if (face.texture >= textures_.size()) {
      fail(fmt::format("face {} refers to texture {}", f, face.texture), fmt::format("an index below {}", textures_.size()));
    }
    if (!within(face.first_vertex, face.vertex_count, vertices_.size())) {
      fail(fmt::format("face {} refers to vertex {}", f, std::uint64_t{face.first_vertex} + face.vertex_count - 1),
           fmt::format("an index below {}", vertices_.size()));
    }
    if (face.type == 2) {
      if (width < 3 || height < 3 || width % 2 == 0 || height % 2 == 0 || std::uint64_t{width} * height != face.vertex_count) {
        fail(fmt::format("patch {} is {} by {} with {} vertices", f, width, height, face.vertex_count),
             "odd sizes from 3 on and a vertex each");
      }
      return;
    }
    if (!within(face.first_mesh_vertex, face.mesh_vertex_count, mesh_vertices_.size()) || face.mesh_vertex_count % 3 != 0) {
      fail(fmt::format("face {} has {} mesh vertices from {}", f, face.mesh_vertex_count, face.first_mesh_vertex),
           fmt::format("a multiple of 3 within {}", mesh_vertices_.size()));
    }
    for (std::uint32_t i = 0; i < face.mesh_vertex_count; ++i) {
      const std::uint32_t corner = mesh_vertices_[face.first_mesh_vertex + i];
      if (corner >= face.vertex_count) {
        fail(fmt::format("face {} refers to its vertex {}", f, corner), fmt::format("an index below {}", face.vertex_count));
      }
    }
  }

  void add(std::uint32_t texture, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back({{a, b, c}});
    triangle_materials_.push_back(texture);
  }

  void add_mesh(const FaceRecord& face, std::uint32_t first) {
    const std::uint32_t* corner = mesh_vertices_.data() + face.first_mesh_vertex;
    for (std::uint32_t i = 0; i < face.mesh_vertex_count; i += 3) {
      add(face.texture, first + corner[i], first + corner[i + 1], first + corner[i + 2]);
    }
  }

  void add_patch(const FaceRecord& face) {
    const auto [width, height] = face.patch_size;
    for (std::uint32_t y = 0; y + 2 < height; y += 2) {
      for (std::uint32_t x = 0; x + 2 < width; x += 2) add_bezier(face, face.first_vertex + y * width + x, width);
    }
  }

  /// One surface over nine control points, three in each of three rows `width` apart.
  void add_bezier(const FaceRecord& face, std::uint32_t control, std::uint32_t width) {
    const auto base = static_cast<std::uint32_t>(positions_.size());
    for (std::uint32_t j = 0; j <= cuts; ++j) {
      for (std::uint32_t i = 0; i <= cuts; ++i) positions_.push_back(bezier(control, width, i, j));
    }
    constexpr std::uint32_t row = cuts + 1;
    for (const bool upper : {false, true}) {
      for (std::uint32_t j = 0; j < cuts; ++j) {
        for (std::uint32_t i = 0; i < cuts; ++i) {
          const std::uint32_t a = base + j * row + i;
          if (upper) {
            add(face.texture, a + 1, a + row, a + row + 1);
          } else {
            add(face.texture, a, a + row, a + 1);
          }
        }
      }
    }
  }

  [[nodiscard]] Vec3 bezier(std::uint32_t control, std::uint32_t width, std::uint32_t i, std::uint32_t j) const {
    const auto weights = [](double t) { return std::array<double, 3>{(1 - t) * (1 - t), 2 * t * (1 - t), t * t}; };
    const auto u = weights(static_cast<double>(i) / cuts);
    const auto v = weights(static_cast<double>(j) / cuts);
    Vec3 point;
    for (int axis = 0; axis < 3; ++axis) {
      double sum = 0;
      for (std::uint32_t y = 0; y < 3; ++y) {
        for (std::uint32_t x = 0; x < 3; ++x) {
          sum += v[y] * u[x] * static_cast<double>(vertices_[control + y * width + x].position[axis]);
        }
      }
      point[axis] = static_cast<float>(sum);
    }
    return point;
  }

  Scene finished() {
    Scene scene;
    for (const TextureRecord& texture : textures_) {
      scene.materials.push_back({.name = std::string(texture.name.data(), strnlen(texture.name.data(), texture.name.size()))});
    }
    scene.vertices = SharedArray<Vec3>(std::move(positions_));
    scene.triangles = SharedArray<Triangle>(std::move(triangles_));
    scene.triangle_materials = SharedArray<std::uint32_t>(std::move(triangle_materials_));
    return scene;
  }

  const SourceFile& source_;
  std::vector<TextureRecord> textures_;
  std::vector<VertexRecord> vertices_;
  std::vector<std::uint32_t> mesh_vertices_;
  std::vector<FaceRecord> faces_;
  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> triangle_materials_;
};

}  // namespace

Scene read_bsp(const SourceFile& source) { return BspReader(source).read(); }

}  // namespace raystudy
