#include "tests/conformance/scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "harness/base/error.h"
#include "harness/geometry/sampling.h"
#include "harness/scene/procedural.h"

namespace raystudy::test {
namespace {

using Corners = std::array<Vec3, 3>;

ConformanceScene of_triangles(std::string name, const std::vector<Corners>& list) {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (const Corners& corners : list) {
    const auto v = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), corners.begin(), corners.end());
    triangles.push_back({{v, v + 1, v + 2}});
  }
  ConformanceScene made{std::move(name), {}};
  made.scene.name = made.name;
  made.scene.vertices = SharedArray<Vec3>(std::move(vertices));
  made.scene.triangles = SharedArray<Triangle>(std::move(triangles));
  // A reader refuses a scene of no triangles; a builder still has to cope with one.
  if (!list.empty()) finish_scene(made.scene, made.name);
  return made;
}

/// `count` random triangles, each coordinate scaled on its own.
std::vector<Corners> random_triangles(int count, Vec3 scale, Vec3 size) {
  const IndexedRandom random(11, 0);
  std::uint64_t next = 0;
  const auto vector = [&] {
    const Vec3 v{random.uniform(next), random.uniform(next + 1), random.uniform(next + 2)};
    next += 3;
    return v;
  };
  std::vector<Corners> list;
  for (int i = 0; i < count; ++i) {
    const Vec3 at = vector() * scale;
    list.push_back({at, at + vector() * size, at + vector() * size});
  }
  return list;
}

std::vector<ConformanceScene> make_all() {
  const Corners one{Vec3{0, 0, 0}, {1, 0, 0.25F}, {0, 1, 0.5F}};
  std::vector<ConformanceScene> all;
  all.push_back(of_triangles("no triangles", {}));
  all.push_back(of_triangles("one triangle", {one}));
  all.push_back(of_triangles("two identical triangles", {one, one}));
  all.push_back(of_triangles("100 identical triangles", std::vector<Corners>(100, one)));
  all.push_back(of_triangles("coplanar", random_triangles(100, {1, 1, 0}, {0.2F, 0.2F, 0})));
  all.push_back(of_triangles("collinear", random_triangles(100, {1, 0, 0}, {0.2F, 0, 0})));
  all.push_back(of_triangles("points", random_triangles(100, {1, 1, 1}, {0, 0, 0})));
  all.push_back(of_triangles("one point", random_triangles(100, {0, 0, 0}, {0, 0, 0})));
  std::vector<Corners> mixed = random_triangles(100, {1, 1, 1}, {0.2F, 0.2F, 0.2F});
  for (std::size_t i = 0; i < mixed.size(); i += 4) mixed[i][2] = mixed[i][i % 8 == 0 ? 0 : 1];
  all.push_back(of_triangles("some of no area", mixed));
  all.push_back(of_triangles("huge", random_triangles(100, {1e18F, 1e18F, 1e18F}, {1e17F, 1e17F, 1e17F})));
  all.back().within_embree_range = false;
  all.push_back(of_triangles("denormal", random_triangles(100, {1e-39F, 1e-39F, 1e-39F}, {1e-39F, 1e-39F, 1e-39F})));
  all.back().within_embree_range = false;
  std::vector<Corners> far = random_triangles(100, {1, 1, 1}, {0.2F, 0.2F, 0.2F});
  for (Corners& corners : far) {
    for (Vec3& v : corners) v += Vec3{1e5F, -1e5F, 1e5F};
  }
  all.push_back(of_triangles("far from the origin", far));
  all.push_back(of_triangles("long and thin", random_triangles(200, {1, 1, 1}, {10, 1e-4F, 1e-4F})));
  std::vector<Corners> growing;
  for (int i = 0; i < 60; ++i) {
    const float s = std::ldexp(1.0F, i - 30);
    growing.push_back({Vec3{s, 0, 0}, {1.5F * s, 0, 0}, {s, 0.5F * s, 0.25F * s}});
  }
  all.push_back(of_triangles("each twice the last", growing));
  for (const ProceduralInfo& info : procedural_scenes()) {
    all.push_back({info.name, make_procedural(info.name, procedural_triangles_min, 1)});
  }
  return all;
}

TEST(ConformanceScenes, NotANumberIsRefused) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Scene scene;
    scene.vertices = SharedArray<Vec3>({{0, 0, 0}, {1, 0, 0}, {0, bad, 0}});
    scene.triangles = SharedArray<Triangle>(std::vector<Triangle>{{{0, 1, 2}}});
    EXPECT_THROW(finish_scene(scene, "bad"), Error);
  }
}

}  // namespace

const std::vector<ConformanceScene>& conformance_scenes() {
  static const std::vector<ConformanceScene> all = make_all();
  return all;
}

std::vector<Ray> conformance_rays(const Scene& scene) {
  const Box box = scene.triangles.empty() ? Box{{0, 0, 0}, {1, 1, 1}} : scene.bounds;
  const IndexedRandom random(17, 0);
  std::uint64_t next = 0;
  const auto point = [&](float around) {
    Vec3 p;
    for (int i = 0; i < 3; ++i) {
      const float s = (1 + 2 * around) * random.uniform(next++) - around;
      p[i] = box.lower[i] + s * (box.upper[i] - box.lower[i]);
    }
    return p;
  };
  std::vector<Ray> rays;
  for (int i = 0; i < 150; ++i) {
    Ray ray;
    ray.origin = point(0.5F);
    ray.direction = point(0) - ray.origin;
    if (i % 5 == 0) ray.tmax = random.uniform(next++);
    if (i % 7 == 0) ray.tmin = 0.5F * random.uniform(next++);
    rays.push_back(ray);
  }
  for (int i = 0; i < 60; ++i) {
    Ray ray;
    ray.origin = point(0.25F);
    ray.direction[i % 3] = i % 2 == 0 ? 1.0F : -1.0F;
    ray.direction[(i + 1) % 3] = i % 4 < 2 ? 0.0F : -0.0F;
    if (i % 5 == 0) ray.origin[(i + 1) % 3] = i % 10 == 0 ? box.lower[(i + 1) % 3] : box.upper[(i + 1) % 3];
    rays.push_back(ray);
  }
  for (std::size_t i = 0; i < 90 && !scene.triangles.empty(); ++i) {
    const Triangle& triangle = scene.triangles[(i * 7919) % scene.triangles.size()];
    const Vec3 a = scene.vertices[triangle[0]];
    const Vec3 b = scene.vertices[triangle[1]];
    Ray ray;
    ray.origin = point(0.5F);
    ray.direction = a + (i % 2 == 0 ? 0.0F : random.uniform(next++)) * (b - a) - ray.origin;
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace raystudy::test
