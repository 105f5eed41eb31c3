#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "harness/geometry/ray.h"
#include "harness/scene/scene.h"

namespace raystudy::test {

/// Triangles anywhere in the cube from -1 to 1 and a little beyond; they share no vertices.
inline Scene soup(int triangles, float size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<Vec3> vertices;
  std::vector<Triangle> list;
  for (int t = 0; t < triangles; ++t) {
    const Vec3 middle{place(random), place(random), place(random)};
    for (int i = 0; i < 3; ++i) vertices.push_back(middle + size * Vec3{place(random), place(random), place(random)});
    const auto v = static_cast<std::uint32_t>(3 * t);
    list.push_back({{v, v + 1, v + 2}});
  }
  Scene scene;
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(list));
  finish_scene(scene, "soup");
  return scene;
}

/// Rays all over that cube, with components of 0 of either sign and limits of t now and then.
inline std::vector<Ray> random_rays(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1.2F, 1.2F);
  std::vector<Ray> rays;
  for (int i = 0; i < count; ++i) {
    Ray ray;
    ray.origin = {place(random), place(random), place(random)};
    ray.direction = {place(random), place(random), place(random)};
    if (i % 4 == 0) ray.direction[i % 3] = i % 8 == 0 ? 0.0F : -0.0F;
    if (i % 16 == 0) ray.direction[(i + 1) % 3] = 0;
    if (i % 5 == 0) ray.tmax = 0.5F;
    if (i % 7 == 0) ray.tmin = 0.3F;
    rays.push_back(ray);
  }
  return rays;
}

/// Rays that hit nothing whatever the scene, each for a reason of its own.
inline std::vector<Ray> invalid_rays() {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::vector<Ray> rays(8, Ray{{0, 0, -3}, 0, {0, 0, 1}, infinity});
  rays[0].direction = {0, 0, 0};
  rays[1].direction = {0, nan, 1};
  rays[2].origin = {infinity, 0, 0};
  rays[3].tmin = -1;
  rays[4].tmax = nan;
  rays[5] = {{0, 0, 0}, 2, {0, 0, 1}, 1};
  rays[6].direction = {0, -infinity, 0};
  rays[7].tmin = nan;
  return rays;
}

inline void expect_same(std::span<const Hit> expected, std::span<const Hit> found) {
  ASSERT_EQ(expected.size(), found.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    ASSERT_EQ(expected[i].triangle, found[i].triangle) << "ray " << i;
    ASSERT_EQ(expected[i].t, found[i].t) << "ray " << i;
    ASSERT_EQ(expected[i].u, found[i].u) << "ray " << i;
    ASSERT_EQ(expected[i].v, found[i].v) << "ray " << i;
  }
}

}  // namespace raystudy::test
