#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

using test::expect_same;
using test::random_rays;
using test::soup;

std::unique_ptr<TraceSession> prepare(const Bvh2& bvh, const Scene& scene, int threads) {
  const auto tracer = Registry::instance().create<Tracer>(Registry::instance().ref(Role::tracer, "scalar"));
  return tracer->prepare(bvh, scene, threads, false);
}

TEST(Scalar, HitsDoNotDependOnTheTree) {
  const Scene scene = soup(300, 0.3F, 1);
  const std::vector<Ray> rays = random_rays(3000, 2);
  const std::vector<Hit> expected = test::closest_hits(scene, rays);
  EXPECT_GT(std::count_if(expected.begin(), expected.end(), [](const Hit& h) { return h.is_hit(); }), 1000);
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const Bvh2 tree = test::random_tree(scene, seed, seed % 3 == 0 ? 1 : 5);
    ASSERT_TRUE(find_problems(tree, scene).empty());
    for (const int threads : {1, 2}) {
      const auto session = prepare(tree, scene, threads);
      std::vector<Hit> hits(rays.size());
      session->trace(rays, hits, Query::closest_hit);
      expect_same(expected, hits);
      session->trace(rays, hits, Query::any_hit);
      for (std::size_t i = 0; i < hits.size(); ++i) ASSERT_EQ(expected[i].is_hit(), hits[i].is_hit()) << "ray " << i;
    }
  }
}

TEST(Scalar, EqualDistancesGoToTheLowestTriangle) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
  scene.triangles = SharedArray<Triangle>(std::vector<Triangle>(40, Triangle{{0, 1, 2}}));
  finish_scene(scene, "forty times one triangle");
  Ray ray;
  ray.origin = {0, 0, -1};
  ray.direction = {0, 0, 1};
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    const Bvh2 tree = test::random_tree(scene, seed, 2);
    Hit hit;
    prepare(tree, scene, 1)->trace({&ray, 1}, {&hit, 1}, Query::closest_hit);
    EXPECT_EQ(hit.triangle, 0U);
    EXPECT_EQ(hit.t, 1.0F);
  }
}

TEST(Scalar, CountsByHand) {
  // Two triangles side by side across x; the ray down the middle of the left one meets the root and the left leaf.
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{-2, -1, 0}, {-1, -1, 0}, {-1.5F, 1, 0}, {1, -1, 0}, {2, -1, 0}, {1.5F, 1, 0}});
  scene.triangles = SharedArray<Triangle>({{{0, 1, 2}}, {{3, 4, 5}}});
  finish_scene(scene, "two triangles");
  Bvh2 bvh;
  bvh.triangles = {0, 1};
  bvh.nodes.resize(4);
  bvh.nodes[2] = {scene.triangle_box(0), 0, 1};
  bvh.nodes[3] = {scene.triangle_box(1), 1, 1};
  bvh.nodes[0] = {united(bvh.nodes[2].box, bvh.nodes[3].box), 2, 0};
  const auto session = prepare(bvh, scene, 1);
  std::vector<Ray> rays(3);
  rays[0].origin = {-1.5F, 0, -1};  // hits the left triangle
  rays[1].origin = {0, 0, -1};      // passes between them, inside the root
  rays[2].origin = {5, 0, -1};      // misses the root
  for (Ray& ray : rays) ray.direction = {0, 0, 1};
  std::vector<std::uint32_t> steps(3);
  const TraceCounts counts = session->count(rays, Query::closest_hit, steps);
  EXPECT_EQ(steps, (std::vector<std::uint32_t>{2, 1, 0}));
  EXPECT_EQ(counts.inner_nodes, 2U);
  EXPECT_EQ(counts.leaves, 1U);
  EXPECT_EQ(counts.triangle_tests, 1U);
  EXPECT_EQ(counts.box_tests, 7U);  // three roots, two pairs
  EXPECT_EQ(counts.traversal_steps(), 3U);
}

TEST(Scalar, CountsAreTheSameForAnyThreads) {
  const Scene scene = soup(500, 0.2F, 3);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  const std::vector<Ray> rays = random_rays(5000, 5);
  std::vector<std::uint32_t> one(rays.size());
  std::vector<std::uint32_t> two(rays.size());
  const TraceCounts a = prepare(tree, scene, 1)->count(rays, Query::closest_hit, one);
  const TraceCounts b = prepare(tree, scene, 2)->count(rays, Query::closest_hit, two);
  EXPECT_EQ(one, two);
  EXPECT_EQ(a.triangle_tests, b.triangle_tests);
  EXPECT_EQ(a.traversal_steps(), b.traversal_steps());
  EXPECT_EQ(a.traversal_steps(), std::accumulate(one.begin(), one.end(), std::uint64_t{0}));
}

TEST(Scalar, TreeAsDeepAsItHasLeaves) {
  constexpr std::uint32_t depth = 100000;
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < depth; ++i) {
    const auto z = static_cast<float>(i);
    vertices.insert(vertices.end(), {{-1, -1, z}, {1, -1, z}, {0, 1, z}});
    triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
  }
  Scene scene;
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  finish_scene(scene, "a stack of triangles");
  // Each inner node has one leaf and the rest: the leaf of triangle i is at depth i + 1, farthest triangles on top.
  Bvh2 bvh;
  bvh.triangles.resize(depth);
  std::iota(bvh.triangles.begin(), bvh.triangles.end(), 0U);
  bvh.nodes.resize(2 * std::size_t{depth});
  std::uint32_t next = 2;
  std::uint32_t slot = 0;
  std::vector<std::uint32_t> inner;
  for (std::uint32_t i = depth; i-- > 1;) {
    inner.push_back(slot);
    bvh.nodes[slot] = {{}, next, 0};
    bvh.nodes[next + 1] = {scene.triangle_box(i), i, 1};
    slot = next;
    next += 2;
  }
  bvh.nodes[slot] = {scene.triangle_box(0), 0, 1};
  for (std::size_t i = inner.size(); i-- > 0;) {
    Bvh2Node& node = bvh.nodes[inner[i]];
    node.box = united(bvh.nodes[node.first].box, bvh.nodes[node.first + 1].box);
  }
  ASSERT_TRUE(find_problems(bvh, scene).empty());
  Ray ray;
  ray.origin = {0, 0, -1};
  ray.direction = {0, 0, 1};
  Hit hit;
  prepare(bvh, scene, 1)->trace({&ray, 1}, {&hit, 1}, Query::closest_hit);
  EXPECT_EQ(hit.triangle, 0U);
  ray.origin.z = static_cast<float>(depth);
  ray.direction.z = -1;
  prepare(bvh, scene, 1)->trace({&ray, 1}, {&hit, 1}, Query::closest_hit);
  EXPECT_EQ(hit.triangle, depth - 1);
}

TEST(Scalar, EmptyTreeAndInvalidRaysHitNothing) {
  const Scene scene = soup(10, 1, 1);
  const Bvh2 tree = test::random_tree(scene, 1, 2);
  const std::vector<Ray> rays = test::invalid_rays();
  for (const Query query : {Query::closest_hit, Query::any_hit}) {
    std::vector<Hit> hits(rays.size(), Hit{1, 1, 1, 1});
    prepare(tree, scene, 1)->trace(rays, hits, query);
    for (const Hit& hit : hits) EXPECT_FALSE(hit.is_hit());
    const Bvh2 empty;
    hits.assign(rays.size(), Hit{1, 1, 1, 1});
    prepare(empty, scene, 1)->trace(rays, hits, query);
    for (const Hit& hit : hits) EXPECT_FALSE(hit.is_hit());
  }
}

}  // namespace
}  // namespace raystudy
