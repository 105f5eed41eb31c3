// OFF and its variants with normals, colours or texture coordinates (NOFF, COFF, STOFF, ...): three coordinates are taken, the
// rest of a vertex's line is skipped. Read here because CGAL's reader says only that it failed, not where.
#include <fmt/format.h>

#include <algorithm>

#include "harness/scene/source.h"
#include "harness/scene/text_cursor.h"

namespace raystudy {
namespace {

class OffReader {
 public:
  explicit OffReader(const SourceFile& source) : cursor_(source) {}

  Scene read() {
    check_header();
    const std::size_t vertex_count = count(word(), "vertices");
    const std::size_t face_count = count(word(), "faces");
    if (vertex_count > cursor_.bytes_left() / 2 || face_count > cursor_.bytes_left() / 2) {
      cursor_.fail(fmt::format("{} vertices and {} faces do not fit into the file", vertex_count, face_count), "a complete file");
    }
    end_line();  // the number of edges, which nobody needs
    std::vector<Vec3> vertices(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i) vertices[i] = vertex(i, vertex_count);
    triangles_.reserve(face_count);
    for (std::size_t i = 0; i < face_count; ++i) face(i, face_count, vertex_count);
    Scene scene;
    scene.vertices = SharedArray<Vec3>(std::move(vertices));
    scene.triangles = SharedArray<Triangle>(std::move(triangles_));
    return scene;
  }

 private:
  void check_header() {
    const std::string_view magic = word();
    if (!magic.ends_with("OFF")) cursor_.fail(fmt::format("the file begins with '{}'", shown(magic)), "OFF");
    if (magic.find_first_of("4n") != std::string_view::npos) {
      cursor_.fail(fmt::format("the variant '{}' is not three-dimensional", magic), "OFF");
    }
  }

  /// The next word that is no comment; fails at the end.
  std::string_view word() {
    std::string_view w = cursor_.next_word();
    while (w.starts_with('#')) {
      (void)cursor_.rest_of_line();
      w = cursor_.next_word();
    }
    if (w == "BINARY") cursor_.fail("binary OFF is not read", "an ASCII file");
    return w;
  }
  void end_line() { (void)cursor_.rest_of_line(); }

  std::size_t count(std::string_view w, std::string_view of) {
    std::size_t n = 0;
    if (!TextCursor::parse(w, n)) {
      cursor_.fail(fmt::format("'{}' stands where the number of {} should", shown(w), of), "a whole number");
    }
    return n;
  }

  Vec3 vertex(std::size_t i, std::size_t total) {
    Vec3 v;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view w = word();
      if (w.empty()) cursor_.fail(fmt::format("the file ends at vertex {} of {}", i, total), "a complete file");
      if (!TextCursor::parse(w, v[axis])) {
        cursor_.fail(fmt::format("'{}' stands where a coordinate should", shown(w)), "a number");
      }
    }
    end_line();
    return v;
  }

  void face(std::size_t i, std::size_t total, std::size_t vertex_count) {
    const std::string_view w = word();
    if (w.empty()) cursor_.fail(fmt::format("the file ends at face {} of {}", i, total), "a complete file");
    const std::size_t corners = count(w, "corners");
    if (corners < 3) cursor_.fail(fmt::format("face {} has {} corners", i, corners), "3 or more");
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < corners; ++k) {
      const std::string_view number = word();
      if (number.empty()) cursor_.fail(fmt::format("the file ends at face {} of {}", i, total), "a complete file");
      std::int64_t index = 0;
      if (!TextCursor::parse(number, index)) {
        cursor_.fail(fmt::format("'{}' stands where a vertex index should", shown(number)), "a whole number");
      }
      if (index < 0 || static_cast<std::size_t>(index) >= vertex_count) {
        cursor_.fail(fmt::format("face {} refers to vertex {}", i, index),
                     fmt::format("0 to {}", static_cast<std::int64_t>(vertex_count) - 1));
      }
      corner[std::min<std::size_t>(k, 2)] = static_cast<std::uint32_t>(index);
      if (k < 2) continue;
      triangles_.push_back({corner});
      corner[1] = corner[2];
    }
    end_line();  // colours
  }

  TextCursor cursor_;
  std::vector<Triangle> triangles_;
};

}  // namespace

Scene read_off(const SourceFile& source) { return OffReader(source).read(); }

}  // namespace raystudy
