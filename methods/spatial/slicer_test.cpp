#include "methods/spatial/slicer.h"

#include <gtest/gtest.h>

#include <vector>

#include "harness/accel/coverage.h"
#include "tests/support/rays.h"

namespace raystudy {
namespace {

TEST(Chopped, HalvesOfARightTriangle) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>(std::vector<Vec3>{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}});
  scene.triangles = SharedArray<Triangle>(std::vector<Triangle>{{{0, 1, 2}}});
  finish_scene(scene, "triangle");
  const auto parts = spatial::chopped(scene, topdown::BoxRecord::of(scene.triangle_box(0), 0), 0, 1);
  EXPECT_EQ(parts[0].box(), Box({0, 0, 0}, {1, 4, 0}));
  // The edge y = 4 - x is at 3 where x is 1; there is room for rounding.
  const Box right = parts[1].box();
  EXPECT_EQ(right.lower, Vec3(1, 0, 0));
  EXPECT_EQ(right.upper.x, 4);
  EXPECT_GE(right.upper.y, 3);
  EXPECT_LT(right.upper.y, 3.0001F);
}

TEST(Chopped, PartsOfPartsCoverEveryTriangle) {
  const Scene scene = test::soup(2000, 0.7F, 3);
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
    std::vector<Box> boxes{scene.triangle_box(t)};
    for (int step = 0; step < 4; ++step) {
      std::vector<Box> parts;
      for (const Box& box : boxes) {
        const int axis = (step + static_cast<int>(t)) % 3;
        const float at = box.lower[axis] + 0.37F * (box.upper[axis] - box.lower[axis]);
        if (!(box.lower[axis] < at && at < box.upper[axis])) {
          parts.push_back(box);
          continue;
        }
        for (const auto& part : spatial::chopped(scene, topdown::BoxRecord::of(box, t), axis, at)) {
          if (!part.is_empty()) parts.push_back(part.box());
        }
      }
      boxes = std::move(parts);
    }
    const Triangle& v = scene.triangles[t];
    ASSERT_TRUE(boxes_cover(boxes, {scene.vertices[v[0]], scene.vertices[v[1]], scene.vertices[v[2]]})) << "triangle " << t;
  }
}

}  // namespace
}  // namespace raystudy
