#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

Scene soup(std::vector<Vec3> vertices) {
  Scene scene;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.push_back({{i, i + 1, i + 2}});
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  return scene;
}

// Three unit right triangles in the planes x = 0, 1 and 9: the best split parts the third from the others.
TEST(SweepSah, PartsTheFarTriangle) {
  std::vector<Vec3> vertices;
  for (const float x : {9.0F, 0.0F, 1.0F}) {
    for (const Vec3 v : {Vec3{x, 0, 0}, Vec3{x, 1, 0}, Vec3{x, 0, 1}}) vertices.push_back(v);
  }
  const Scene scene = soup(vertices);
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, "sweep-sah"));
  const auto accel = builder->build(scene, {});
  const auto& bvh = dynamic_cast<const Bvh2&>(*accel);
  EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(1, 2, 0));
  // Half areas: root 9 x 1 x 1: 19; the pair 1 x 1 x 1: 3; a triangle's box 1. (3 (19 + 3) + 2 (1 + 1 + 1)) / 19.
  EXPECT_DOUBLE_EQ(tree_cost(bvh, {}), 72.0 / 19);
}

}  // namespace
}  // namespace raystudy
