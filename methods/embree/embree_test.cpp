#include <gtest/gtest.h>
#include <immintrin.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>

#include "harness/method/registry.h"
#include "harness/scene/procedural.h"

namespace raystudy {
namespace {

/// Two unit-high squares facing the ray, at z = 1 and z = 2.
Scene squares() {
  Scene scene;
  scene.vertices =
      SharedArray<Vec3>({{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-3, -3, 2}, {3, -3, 2}, {3, 3, 2}, {-3, 3, 2}});
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{0, 2, 3}}, {{4, 5, 6}}, {{4, 6, 7}}});
  finish_scene(scene, "squares");
  return scene;
}

std::vector<Ray> rays_at_squares() {
  std::vector<Ray> rays;
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      Ray ray;
      ray.origin = {static_cast<float>(x) - 3.9F, static_cast<float>(y) - 4.1F, 0};
      ray.direction = {0, 0, 1};
      rays.push_back(ray);
    }
  }
  return rays;
}

std::unique_ptr<Accel> build(const Scene& scene, std::map<std::string, ParamValue, std::less<>> changes, int threads = 1) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  return registry.create<Builder>(registry.ref(Role::builder, "embree", std::move(changes)))->build(scene, context);
}

std::vector<Hit> trace(const Accel& accel, const Scene& scene, std::string width, Query query, int threads = 1) {
  const Registry& registry = Registry::instance();
  const auto tracer = registry.create<Tracer>(registry.ref(Role::tracer, "embree", {{"width", std::move(width)}}));
  const std::vector<Ray> rays = rays_at_squares();
  std::vector<Hit> hits(rays.size());
  tracer->prepare(accel, scene, threads, true)->trace(rays, hits, query);
  return hits;
}

TEST(Embree, EveryWidthAndFlagHitsTheSame) {
  const Scene scene = squares();
  const std::vector<Ray> rays = rays_at_squares();
  for (const char* quality : {"low", "medium", "high"}) {
    for (const bool flag : {false, true}) {
      const auto accel =
          build(scene, {{"quality", std::string(quality)}, {"robust", flag}, {"compact", flag}, {"dynamic", flag}});
      EXPECT_EQ(accel->kind(), "embree");
      EXPECT_GT(accel->bytes(), 0U);
      for (const char* width : {"1", "8", "16", "stream"}) {
        const std::vector<Hit> closest = trace(*accel, scene, width, Query::closest_hit);
        const std::vector<Hit> any = trace(*accel, scene, width, Query::any_hit, 2);
        for (std::size_t i = 0; i < rays.size(); ++i) {
          const float far = std::max(std::abs(rays[i].origin.x), std::abs(rays[i].origin.y));
          EXPECT_EQ(closest[i].t, far < 1 ? 1.0F : far < 3 ? 2.0F : std::numeric_limits<float>::infinity());
          EXPECT_EQ(closest[i].is_hit(), far < 3);
          EXPECT_EQ(any[i].is_hit(), far < 3);
          if (!closest[i].is_hit()) continue;
          // u and v weigh the second and third vertex.
          const Triangle& v = scene.triangles[closest[i].triangle];
          const Vec3 a = scene.vertices[v[0]];
          const Vec3 p = a + closest[i].u * (scene.vertices[v[1]] - a) + closest[i].v * (scene.vertices[v[2]] - a);
          EXPECT_NEAR(p.x, rays[i].origin.x, 1e-5F);
          EXPECT_NEAR(p.y, rays[i].origin.y, 1e-5F);
        }
      }
    }
  }
}

TEST(Embree, AnEmptySceneIsBuiltAndHitByNothing) {
  const Scene scene;
  const auto accel = build(scene, {});
  for (const Hit& hit : trace(*accel, scene, "8", Query::closest_hit)) EXPECT_FALSE(hit.is_hit());
}

TEST(Embree, KeepsTheSceneArraysAlive) {
  std::unique_ptr<Accel> accel;
  {
    const Scene scene = squares();
    accel = build(scene, {});
  }
  EXPECT_TRUE(trace(*accel, Scene{}, "1", Query::closest_hit)[40].is_hit());
}

double processor_seconds(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

TEST(Embree, BuildsOnOneThreadWhereToldSo) {
  const Scene scene = make_procedural("soup", 100'000, 1);
  const double before = processor_seconds(RUSAGE_SELF);
  const double before_here = processor_seconds(RUSAGE_THREAD);
  (void)build(scene, {});
  const double all = processor_seconds(RUSAGE_SELF) - before;
  const double here = processor_seconds(RUSAGE_THREAD) - before_here;
  EXPECT_GT(here, 0.75 * all) << "other threads built too";  // half of it, where two threads build
}

TEST(Embree, DenormalsAreFlushedOnlyWhileTracing) {
  const Scene scene = squares();
  const auto accel = build(scene, {});
  const unsigned before = _mm_getcsr();
  (void)trace(*accel, scene, "16", Query::closest_hit);
  EXPECT_EQ(_mm_getcsr() & 0x8040U, before & 0x8040U);
}

TEST(Embree, VerticesThatEndAtAPageAreNotReadPast) {
  // The last vertex ends where the next page must not be read: Embree's 16-byte loads would crash on the scene's own array.
  constexpr std::size_t page = 4096;
  constexpr std::size_t count = page / 4;  // 3 pages of vertices
  auto* memory = static_cast<std::byte*>(mmap(nullptr, 4 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(static_cast<void*>(memory), MAP_FAILED);
  ASSERT_EQ(mprotect(memory + 3 * page, page, PROT_NONE), 0);
  const std::shared_ptr<const void> keep(memory, [](const void* p) { munmap(const_cast<void*>(p), 4 * page); });
  const std::span<Vec3> vertices(reinterpret_cast<Vec3*>(memory), count);
  const Scene plain = squares();
  std::copy(plain.vertices.begin(), plain.vertices.end(), vertices.end() - 8);
  Scene scene = plain;
  scene.vertices = SharedArray<Vec3>(keep, vertices);
  scene.triangles =
      SharedArray<Triangle>({{{1016, 1017, 1018}}, {{1016, 1018, 1019}}, {{1020, 1021, 1022}}, {{1020, 1022, 1023}}});
  const auto accel = build(scene, {});
  EXPECT_EQ(trace(*accel, scene, "1", Query::closest_hit)[40].t, 1.0F);
  EXPECT_LT(accel->bytes(), build(plain, {})->bytes() + page);  // the copy of the vertices is not counted
}

}  // namespace
}  // namespace raystudy
