#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/scene/scene.h"

namespace raystudy::test {

/// A scene with one triangle for each box, whose bounding box is that box.
inline Scene scene_of(const std::vector<Box>& boxes) {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (const Box& b : boxes) {
    const auto v = static_cast<std::uint32_t>(vertices.size());
    vertices.push_back(b.lower);
    vertices.push_back(b.upper);
    vertices.emplace_back(b.lower.x, b.upper.y, b.lower.z);
    triangles.push_back({{v, v + 1, v + 2}});
  }
  Scene scene;
  scene.name = "boxes";
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  if (!boxes.empty()) finish_scene(scene, "boxes");
  return scene;
}

/// `count` random boxes of sizes over three decades in the unit cube, flat in one axis now and then.
inline std::vector<Box> random_boxes(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return static_cast<float>(random() >> 40U) * 0x1p-24F; };
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const float size = uniform() < 0.2F ? 0.3F : uniform() < 0.5F ? 0.03F : 0.001F;
    const Vec3 lower{uniform(), uniform(), uniform()};
    Vec3 extent = Vec3{uniform(), uniform(), uniform()} * size;
    if (i % 5 == 0) extent[static_cast<int>(i % 3)] = 0;
    boxes.emplace_back(lower, lower + extent);
  }
  return boxes;
}

/// [from, to] x [0, 1] x [0, 1], of half area 2 (to - from) + 1.
inline Box bar(float from, float to) { return {{from, 0, 0}, {to, 1, 1}}; }

/// Nodes of trees by hand: a leaf of one triangle, and an inner node with children at `children`.
inline Bvh2Node leaf(const Box& box, std::uint32_t first) { return {box, first, 1}; }
inline Bvh2Node inner(const Box& box, std::uint32_t children) { return {box, children, 0}; }

/// A valid but bad tree: the triangles in random order, split at random places, up to `leaf_triangles` a leaf.
class RandomTree {
 public:
  RandomTree(const Scene& scene, std::uint64_t seed, std::uint32_t leaf_triangles)
      : scene_(scene), random_(seed), leaf_triangles_(leaf_triangles) {}

  Bvh2 build() {
    const auto count = static_cast<std::uint32_t>(scene_.triangles.size());
    for (std::uint32_t t = 0; t < count; ++t) bvh_.triangles.push_back(t);
    for (std::uint32_t t = count; t > 1; --t) std::swap(bvh_.triangles[t - 1], bvh_.triangles[random_() % t]);
    if (count > 0) {
      bvh_.nodes.resize(2);
      split(0, 0, count);
    }
    return std::move(bvh_);
  }

 private:
  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t end) {
    Box box;
    for (std::uint32_t i = begin; i < end; ++i) box.extend(scene_.triangle_box(bvh_.triangles[i]));
    if (end - begin <= leaf_triangles_) {
      bvh_.nodes[node] = {box, begin, end - begin};
      return;
    }
    const auto children = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes.resize(children + 2);
    bvh_.nodes[node] = {box, children, 0};
    // In the middle half, so that recursion stays shallow however many triangles there are.
    const std::uint32_t half = std::max(1U, (end - begin) / 2);
    const std::uint32_t middle = begin + std::clamp(half / 2 + static_cast<std::uint32_t>(random_() % half), 1U, end - begin - 1);
    split(children, begin, middle);
    split(children + 1, middle, end);
  }

  const Scene& scene_;
  std::mt19937_64 random_;
  std::uint32_t leaf_triangles_;
  Bvh2 bvh_;
};

inline Bvh2 random_tree(const Scene& scene, std::uint64_t seed, std::uint32_t leaf_triangles = 1) {
  return RandomTree(scene, seed, leaf_triangles).build();
}

}  // namespace raystudy::test
