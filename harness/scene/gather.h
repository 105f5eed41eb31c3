#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "harness/scene/scene.h"

namespace raystudy {

/// Gives vertices that are equal bit for bit one index, in the order of their first use; the sign of a zero does not count.
void weld_equal(std::vector<Vec3>& positions, std::vector<Triangle>& triangles);

/// Collects meshes into one unfinished scene.
struct Gather {
  std::string source;  ///< the file, for messages
  Scene scene = {};    ///< materials, lights and cameras, filled by the reader
  std::vector<Vec3> vertices = {};
  std::vector<Triangle> triangles = {};
  std::vector<std::uint32_t> materials = {};

  /// Adds vertices and returns the index of the first.
  std::uint32_t add_vertices(std::span<const Vec3> positions);
  /// Adds triangles over the `count` vertices from `base` on; throws Error naming `source` where an index is not below `count`.
  void add_triangles(std::span<const Triangle> mesh, std::uint32_t base, std::size_t count, std::uint32_t material);
  void add(std::span<const Vec3> positions, std::span<const Triangle> mesh, std::uint32_t material) {
    add_triangles(mesh, add_vertices(positions), positions.size(), material);
  }
  [[nodiscard]] Scene finished();
};

}  // namespace raystudy
