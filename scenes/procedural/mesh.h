#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/geometry/vec3.h"
#include "harness/scene/scene.h"
#include "scenes/procedural/numeric.h"

namespace raystudy::procedural {

/// A place and three axes: carries local coordinates into the scene.
struct Frame {
  Vec3 origin;
  Vec3 x{1, 0, 0};
  Vec3 y{0, 1, 0};
  Vec3 z{0, 0, 1};

  [[nodiscard]] constexpr Vec3 at(Vec3 p) const { return origin + x * p.x + y * p.y + z * p.z; }
  /// The same axes, moved by `p` in local coordinates.
  [[nodiscard]] constexpr Frame moved(Vec3 p) const { return {at(p), x, y, z}; }
};

/// Collects a scene's triangles. A counting mesh takes the same calls and only counts, so that a generator can find the level of
/// detail that gives the wanted count and then fill arrays of exactly the right size.
class Mesh {
 public:
  explicit Mesh(bool counting) : counting_(counting) {}
  /// An empty mesh with room for what `counted` has counted.
  static Mesh sized_as(const Mesh& counted) {
    Mesh mesh(false);
    mesh.reserve(counted.vertex_count_, counted.triangle_count_);
    return mesh;
  }

  /// Makes room for what will be added, so that nothing is allocated beyond it.
  void reserve(std::size_t vertices, std::size_t triangles) {
    vertices_.reserve(vertices);
    triangles_.reserve(triangles);
    materials_.reserve(triangles);
  }

  [[nodiscard]] bool counting() const { return counting_; }
  [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }
  [[nodiscard]] std::int64_t triangle_count() const { return static_cast<std::int64_t>(triangle_count_); }
  /// The material of what is added from now on.
  void material(std::uint32_t index) { material_ = index; }

  /// A curved patch of 2 · nu · nv triangles: position(u, v) for u, v in [0, 1]. With `wrap` the last column is the first again.
  template <class F>
  void grid(int nu, int nv, bool wrap, F&& position);
  /// A polygon of n corners rim(i / n) around `center`.
  template <class F>
  void fan(int n, Vec3 center, F&& rim);
  void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d);
  void triangle(Vec3 a, Vec3 b, Vec3 c);
  /// Twelve triangles from `lower` to `upper` in the coordinates of `frame`.
  void box(const Frame& frame, Vec3 lower, Vec3 upper);
  /// A closed ball of 8 n² triangles and 4 n² + 2 vertices: position(direction) for unit directions.
  template <class F>
  void ball(int n, F&& position);
  /// Triangles that index `vertices`.
  void surface(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

  /// Gives every triangle so far the material pick(index, a, b, c).
  template <class F>
  void classify(F&& pick) {
    parallel_for_indices(triangles_.size(), [&](std::size_t t) {
      const Triangle& corners = triangles_[t];
      materials_[t] = pick(t, vertices_[corners[0]], vertices_[corners[1]], vertices_[corners[2]]);
    });
  }
  /// Gives everything to `scene`.
  void move_into(Scene& scene) {
    scene.vertices = SharedArray<Vec3>(std::move(vertices_));
    scene.triangles = SharedArray<Triangle>(std::move(triangles_));
    scene.triangle_materials = SharedArray<std::uint32_t>(std::move(materials_));
  }

 private:
  /// Makes room; returns the index of the first new vertex and of the first new triangle.
  std::pair<std::uint32_t, std::size_t> add(std::size_t vertices, std::size_t triangles) {
    const auto first_vertex = static_cast<std::uint32_t>(vertex_count_);
    const std::size_t first_triangle = triangle_count_;
    vertex_count_ += vertices;
    triangle_count_ += triangles;
    if (!counting_) {
      vertices_.resize(vertex_count_);
      triangles_.resize(triangle_count_);
      materials_.resize(triangle_count_, material_);
    }
    return {first_vertex, first_triangle};
  }

  bool counting_;
  std::size_t vertex_count_ = 0;
  std::size_t triangle_count_ = 0;
  std::uint32_t material_ = 0;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> materials_;
};

/// Calls row(i) for i in [0, n), on several threads where the rows are long enough to be worth it.
template <class F>
void for_rows(int n, std::size_t row_length, F&& row) {
  if (static_cast<std::size_t>(n) * row_length < 20'000) {
    for (int i = 0; i < n; ++i) row(i);
  } else {
    parallel_for_indices(static_cast<std::size_t>(n), [&](std::size_t i) { row(static_cast<int>(i)); });
  }
}

template <class F>
void Mesh::grid(int nu, int nv, bool wrap, F&& position) {
  const auto columns = static_cast<std::size_t>(wrap ? nu : nu + 1);
  const auto [first, first_triangle] = add(columns * static_cast<std::size_t>(nv + 1), std::size_t{2} * nu * nv);
  if (counting_) return;
  for_rows(nv + 1, columns, [&, first = first](int j) {
    Vec3* out = &vertices_[first + static_cast<std::size_t>(j) * columns];
    const float v = static_cast<float>(j) / static_cast<float>(nv);
    for (std::size_t i = 0; i < columns; ++i) out[i] = position(static_cast<float>(i) / static_cast<float>(nu), v);
  });
  for_rows(nv, columns, [&, first = first, first_triangle = first_triangle](int j) {
    const auto row = static_cast<std::uint32_t>(columns);
    const std::uint32_t low = first + static_cast<std::uint32_t>(j) * row;
    Triangle* out = &triangles_[first_triangle + std::size_t{2} * nu * j];
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(nu); ++i) {
      const std::uint32_t next = i + 1 == row ? 0 : i + 1;
      *out++ = {{low + i, low + next, low + row + next}};
      *out++ = {{low + i, low + row + next, low + row + i}};
    }
  });
}

template <class F>
void Mesh::fan(int n, Vec3 center, F&& rim) {
  const auto [first, first_triangle] = add(static_cast<std::size_t>(n) + 1, static_cast<std::size_t>(n));
  if (counting_) return;
  vertices_[first] = center;
  for (int i = 0; i < n; ++i) {
    const auto corner = static_cast<std::uint32_t>(i);
    vertices_[first + 1 + corner] = rim(static_cast<float>(i) / static_cast<float>(n));
    triangles_[first_triangle + corner] = {{first, first + 1 + corner, first + 1 + (i + 1 == n ? 0 : corner + 1)}};
  }
}

inline void Mesh::quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const auto [first, first_triangle] = add(4, 2);
  if (counting_) return;
  vertices_[first] = a;
  vertices_[first + 1] = b;
  vertices_[first + 2] = c;
  vertices_[first + 3] = d;
  triangles_[first_triangle] = {{first, first + 1, first + 2}};
  triangles_[first_triangle + 1] = {{first, first + 2, first + 3}};
}

inline void Mesh::triangle(Vec3 a, Vec3 b, Vec3 c) {
  const auto [first, first_triangle] = add(3, 1);
  if (counting_) return;
  vertices_[first] = a;
  vertices_[first + 1] = b;
  vertices_[first + 2] = c;
  triangles_[first_triangle] = {{first, first + 1, first + 2}};
}

inline void Mesh::box(const Frame& frame, Vec3 lower, Vec3 upper) {
  const auto [first, first_triangle] = add(8, 12);
  if (counting_) return;
  for (std::uint32_t i = 0; i < 8; ++i) {
    vertices_[first + i] =
        frame.at({(i & 1U) != 0 ? upper.x : lower.x, (i & 2U) != 0 ? upper.y : lower.y, (i & 4U) != 0 ? upper.z : lower.z});
  }
  // Corner i lies at the upper end of x, y, z where its bit 0, 1, 2 is set; seen from outside the corners turn left.
  static constexpr std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  Triangle* out = &triangles_[first_triangle];
  for (const auto& f : faces) {
    *out++ = {{first + f[0], first + f[1], first + f[2]}};
    *out++ = {{first + f[0], first + f[2], first + f[3]}};
  }
}

namespace ball_rings {

// Rings of equal latitude from pole to pole: 1, 4, 8, ..., 4 n, ..., 8, 4, 1 vertices.
constexpr std::uint32_t quarter(std::uint32_t ring, std::uint32_t n) { return ring < n ? ring : 2 * n - ring; }
constexpr std::uint32_t first(std::uint32_t ring, std::uint32_t n) {
  const std::uint32_t m = quarter(ring, n);
  if (ring == 0) return 0;
  return ring <= n ? 1 + 2 * m * (m - 1) : 4 * n * n + 1 - 2 * m * (m + 1);
}
/// Vertex `i` of quarter `q` of a ring.
constexpr std::uint32_t vertex(std::uint32_t ring, std::uint32_t q, std::uint32_t i, std::uint32_t n) {
  const std::uint32_t m = quarter(ring, n);
  return m == 0 ? first(ring, n) : first(ring, n) + (q * m + i) % (4 * m);
}

}  // namespace ball_rings

template <class F>
void Mesh::ball(int n, F&& position) {
  const auto size = static_cast<std::uint32_t>(n);
  const auto [first, first_triangle] = add(std::size_t{4} * size * size + 2, std::size_t{8} * size * size);
  if (counting_) return;
  Triangle* out = &triangles_[first_triangle];
  for (std::uint32_t ring = 0; ring <= 2 * size; ++ring) {
    const std::uint32_t m = ball_rings::quarter(ring, size);
    const double down = 0.25 * ring / size;
    for (std::uint32_t i = 0; i < std::max(1U, 4 * m); ++i) {
      const double turn = m == 0 ? 0 : 0.25 * i / m;
      const float r = m == 0 ? 0 : sin_turns(down);
      vertices_[first + ball_rings::first(ring, size) + i] =
          position(Vec3{r * cos_turns(turn), cos_turns(down), r * sin_turns(turn)});
    }
  }
  const auto at = [&, first = first](std::uint32_t ring, std::uint32_t q, std::uint32_t i) {
    return first + ball_rings::vertex(ring, q, i, size);
  };
  for (std::uint32_t ring = 0; ring < 2 * size; ++ring) {
    const bool widens = ring < size;
    const std::uint32_t m = widens ? ring : 2 * size - ring - 1;  // a quarter has m cells on one ring, m + 1 on the other
    for (std::uint32_t q = 0; q < 4; ++q) {
      for (std::uint32_t i = 0; i <= m; ++i) {
        if (widens) {
          *out++ = {{at(ring, q, i), at(ring + 1, q, i + 1), at(ring + 1, q, i)}};
          if (i < m) *out++ = {{at(ring, q, i), at(ring, q, i + 1), at(ring + 1, q, i + 1)}};
        } else {
          *out++ = {{at(ring + 1, q, i), at(ring, q, i), at(ring, q, i + 1)}};
          if (i < m) *out++ = {{at(ring + 1, q, i), at(ring, q, i + 1), at(ring + 1, q, i + 1)}};
        }
      }
    }
  }
}

inline void Mesh::surface(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  const auto [first, first_triangle] = add(vertices.size(), triangles.size());
  if (counting_) return;
  std::copy(vertices.begin(), vertices.end(), vertices_.begin() + first);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) triangles_[first_triangle + t].vertex[i] = first + triangles[t].vertex[i];
  }
}

}  // namespace raystudy::procedural
