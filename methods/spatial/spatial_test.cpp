#include <gtest/gtest.h>

#include <random>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "methods/spatial/slicer.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/same_tree.h"

namespace raystudy::spatial {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Bvh2 build(std::string_view name, const Scene& scene, Changes changes = {}, int threads = 1) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  const auto accel = registry.create<Builder>(registry.ref(Role::builder, name, std::move(changes)))->build(scene, context);
  return dynamic_cast<const Bvh2&>(*accel);
}

double cost_of(const Bvh2& bvh) { return tree_cost(bvh, CostModel()); }

/// Long thin triangles in all directions, whose boxes overlap as they do not.
Scene sticks(int count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-1, 1);
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const Vec3 from{place(random), place(random), place(random)};
    const auto v = static_cast<std::uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {from, from + Vec3{0.001F, 0, 0}, Vec3{place(random), place(random), place(random)}});
    triangles.push_back({{v, v + 1, v + 2}});
  }
  Scene scene;
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  finish_scene(scene, "sticks");
  return scene;
}

bool holds(const Box& box, const std::array<double, 3>& point) {
  for (int a = 0; a < 3; ++a) {
    const double x = point[static_cast<std::size_t>(a)];
    if (x < static_cast<double>(box.lower[a]) || x > static_cast<double>(box.upper[a])) return false;
  }
  return true;
}

TEST(Chopped, PartsHoldWhatIsOnTheirSide) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> share(0, 1);
  int points = 0;
  for (const float size : {1e-3F, 1.0F, 1e4F}) {
    const Scene scene = test::soup(200, size, 3);
    for (std::uint32_t t = 0; t < 200; ++t) {
      // A part of the triangle's box, as earlier splits leave it.
      Box box = scene.triangle_box(t);
      for (int a = 0; a < 3; ++a) box.lower[a] += share(random) * 0.5F * (box.upper[a] - box.lower[a]);
      const int axis = static_cast<int>(t % 3);
      const float at = box.lower[axis] + share(random) * (box.upper[axis] - box.lower[axis]);
      if (!(box.lower[axis] < at && at < box.upper[axis])) continue;
      const auto parts = chopped(scene, BoxRecord::of(box, t), axis, at);
      for (int i = 0; i < 200; ++i) {
        double u = static_cast<double>(share(random));
        double v = static_cast<double>(share(random));
        if (u + v > 1) u = 1 - u, v = 1 - v;
        std::array<double, 3> point{};
        for (int a = 0; a < 3; ++a) {
          const auto corner = [&](int k) { return static_cast<double>(scene.vertices[scene.triangles[t][k]][a]); };
          point[static_cast<std::size_t>(a)] = corner(0) * (1 - u - v) + corner(1) * u + corner(2) * v;
        }
        if (!holds(box, point)) continue;
        ++points;
        const std::size_t side = point[static_cast<std::size_t>(axis)] < static_cast<double>(at) ? 0 : 1;
        ASSERT_TRUE(holds(parts[side].box(), point)) << "triangle " << t << ", point " << i << ", size " << size;
      }
      ASSERT_LE(parts[0].box().upper[axis], at);
      ASSERT_GE(parts[1].box().lower[axis], at);
    }
  }
  EXPECT_GT(points, 1000);
}

TEST(Sbvh, WithoutABudgetIsBinnedSah) {
  const Scene scene = test::soup(3000, 0.1F, 1);
  for (const char* leaves : {"single", "sah"}) {
    Bvh2 objects = build("sbvh", scene, {{"budget", 0.0}, {"leaves", std::string(leaves)}});
    objects.duplicates = false;
    EXPECT_TRUE(test::same(objects, build("binned-sah", scene, {{"leaves", std::string(leaves)}}))) << leaves;
  }
}

TEST(Sbvh, TriesPlanesOnlyWhereSidesOverlapByMoreThanAlpha) {
  const Scene scene = sticks(2000, 1);
  EXPECT_EQ(build("sbvh", scene, {{"alpha", 1.0}}).triangles.size(), 2000U);
  const std::size_t some = build("sbvh", scene, {{"alpha", 0.01}}).triangles.size();
  const std::size_t many = build("sbvh", scene, {{"alpha", 0.0}}).triangles.size();
  EXPECT_GT(some, 2000U);
  EXPECT_GT(many, some);
}

TEST(Sbvh, KeepsItsBudget) {
  const Scene scene = sticks(3000, 2);
  for (const double budget : {0.01, 0.1, 0.5, 1.0, 4.0}) {
    const Bvh2 bvh = build("sbvh", scene, {{"budget", budget}});
    EXPECT_LE(static_cast<double>(bvh.triangles.size()), 3000 * (1 + budget));
    EXPECT_GT(bvh.triangles.size(), 3000U);
    EXPECT_TRUE(find_problems(bvh, scene).empty()) << budget;
  }
}

TEST(Sbvh, CostsLessThanObjectSplitsWhereTrianglesAreLong) {
  const Scene scene = sticks(3000, 3);
  EXPECT_LT(cost_of(build("sbvh", scene, {{"budget", 4.0}})), 0.95 * cost_of(build("binned-sah", scene)));
}

TEST(Sbvh, IsTheSameWhateverTheThreads) {
  const Scene scene = sticks(30000, 4);
  for (const char* leaves : {"single", "sah"}) {
    const Bvh2 one = build("sbvh", scene, {{"leaves", std::string(leaves)}});
    EXPECT_TRUE(find_problems(one, scene).empty());
    for (const int threads : {2, 3}) {
      EXPECT_TRUE(test::same(one, build("sbvh", scene, {{"leaves", std::string(leaves)}}, threads))) << leaves << ' ' << threads;
    }
  }
}

TEST(Sbvh, OfNoTrianglesIsEmpty) { EXPECT_TRUE(build("sbvh", Scene{}).empty()); }

/// Optimizers move parts of triangles as they move triangles: the tree stays valid, costs no more, and is traced to the same
/// hits.
TEST(SbvhTrees, AreOptimizedLikeOthers) {
  const Registry& registry = Registry::instance();
  const Scene scene = test::soup(800, 0.6F, 5);
  const Bvh2 start = build("sbvh", scene);
  ASSERT_GT(start.triangles.size(), scene.triangles.size());
  const std::vector<Ray> rays = test::random_rays(2000, 6);
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  for (const std::string& name : registry.names(Role::optimizer)) {
    SCOPED_TRACE(name);
    Bvh2 bvh = start;
    registry.create<Optimizer>(registry.ref(Role::optimizer, name))->optimize(bvh, scene, {});
    ASSERT_TRUE(find_problems(bvh, scene).empty());
    EXPECT_LE(cost_of(bvh), cost_of(start) * (1 + 1e-6));
    std::vector<Hit> hits(rays.size());
    registry.create<Tracer>(registry.ref(Role::tracer, "scalar"))
        ->prepare(bvh, scene, 1, false)
        ->trace(rays, hits, Query::closest_hit);
    test::expect_same(expected, hits);
  }
  for (const char* name : {"insertion", "insertion-parallel"}) {
    Bvh2 bvh = start;
    registry.create<Optimizer>(registry.ref(Role::optimizer, name))->optimize(bvh, scene, {});
    EXPECT_LT(cost_of(bvh), 0.99 * cost_of(start)) << name;
  }
}

}  // namespace
}  // namespace raystudy::spatial
