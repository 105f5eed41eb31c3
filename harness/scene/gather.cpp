#include "harness/scene/gather.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <utility>

#include "harness/scene/bytes.h"

namespace raystudy {

void weld_equal(std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
  if (positions.empty() || triangles.empty()) return;
  for (Vec3& p : positions) p = p + Vec3{};  // -0 + 0 = 0
  std::vector<unsigned> corners;
  corners.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (const std::uint32_t v : t.vertex) {
      if (v >= positions.size()) return;  // finish_scene will name it
      corners.push_back(v);
    }
  }
  std::vector<unsigned> remap(positions.size());
  const std::size_t count =
      meshopt_generateVertexRemap(remap.data(), corners.data(), corners.size(), positions.data(), positions.size(), sizeof(Vec3));
  std::vector<Vec3> welded(count);
  for (const unsigned v : corners) welded[remap[v]] = positions[v];
  for (Triangle& t : triangles) {
    for (std::uint32_t& v : t.vertex) v = remap[v];
  }
  positions = std::move(welded);
}

std::uint32_t Gather::add_vertices(std::span<const Vec3> positions) {
  const auto base = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), positions.begin(), positions.end());
  return base;
}

void Gather::add_triangles(std::span<const Triangle> mesh, std::uint32_t base, std::size_t count, std::uint32_t material) {
  for (const Triangle& t : mesh) {
    for (const std::uint32_t v : t.vertex) {
      // Checked here: past its own mesh an index would name a vertex of the next.
      if (v >= count) {
        fail_at(source, fmt::format("triangle {} refers to vertex {} of its mesh", triangles.size(), v),
                fmt::format("an index below {}", count));
      }
    }
    triangles.push_back({{base + t[0], base + t[1], base + t[2]}});
  }
  materials.insert(materials.end(), mesh.size(), material);
}

Scene Gather::finished() {
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  if (scene.materials.size() > 1) scene.triangle_materials = SharedArray<std::uint32_t>(std::move(materials));
  return std::move(scene);
}

}  // namespace raystudy
