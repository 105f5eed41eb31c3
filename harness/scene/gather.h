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

  /// Indices of `mesh` count within `positions`; throws Error naming `source` where one does not.
  void add(std::span<const Vec3> positions, std::span<const Triangle> mesh, std::uint32_t material);
  [[nodiscard]] Scene finished();
};

}  // namespace raystudy
