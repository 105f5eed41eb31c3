#include "harness/report/clusters.h"

#include <gmock/gmock.h>

#include <algorithm>

namespace raystudy {
namespace {

using testing::ElementsAre;

/// ((t2, t0), ((t1), (t3, t4))): leaves of 2, 1 and 2 triangles.
Bvh2 tree() {
  Bvh2 bvh;
  const Box box{{0, 0, 0}, {1, 1, 1}};
  bvh.nodes.resize(6);
  bvh.nodes[0] = {box, 2, 0};
  bvh.nodes[2] = {box, 0, 2};
  bvh.nodes[3] = {box, 4, 0};
  bvh.nodes[4] = {box, 2, 1};
  bvh.nodes[5] = {box, 3, 2};
  bvh.triangles = {2, 0, 1, 3, 4};
  return bvh;
}

TEST(Clusters, AreTheTopmostNodesBelowTheSize) {
  EXPECT_THAT(clusters_of(tree(), 6), ElementsAre(0, 0, 0, 0, 0)) << "the root has fewer than 6";
  EXPECT_THAT(clusters_of(tree(), 5), ElementsAre(0, 1, 0, 1, 1));
  EXPECT_THAT(clusters_of(tree(), 3), ElementsAre(0, 1, 0, 2, 2));
  EXPECT_THAT(clusters_of(tree(), 1), ElementsAre(0, 1, 0, 2, 2)) << "leaves are not cut";
  EXPECT_TRUE(clusters_of(Bvh2(), 1).empty());
}

TEST(Clusters, ColorsDifferAndAreColors) {
  for (std::uint32_t c = 0; c < 200; ++c) {
    const Vec3 color = cluster_color(c);
    EXPECT_LE(std::max({color.x, color.y, color.z}), 1);
    EXPECT_GT(std::min({color.x, color.y, color.z}), 0);
    EXPECT_GT(length(color - cluster_color(c + 1)), 0.3F) << c;
  }
}

}  // namespace
}  // namespace raystudy
