#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "harness/method/registry.h"

namespace raystudy {
namespace {

/// Root (a 4 × 2 × 2 box) over a leaf of two triangles (2 × 2 × 2) and an inner node (2 × 2 × 2) over two leaves (1 × 2 × 2).
Bvh2 small_tree() {
  Bvh2 bvh;
  bvh.triangles = {3, 1, 0, 2};
  bvh.nodes.resize(6);
  bvh.nodes[0] = {{{0, 0, 0}, {4, 2, 2}}, 2, 0};
  bvh.nodes[2] = {{{0, 0, 0}, {2, 2, 2}}, 0, 2};
  bvh.nodes[3] = {{{2, 0, 0}, {4, 2, 2}}, 4, 0};
  bvh.nodes[4] = {{{2, 0, 0}, {3, 2, 2}}, 2, 1};
  bvh.nodes[5] = {{{3, 0, 0}, {4, 2, 2}}, 3, 1};
  return bvh;
}

std::map<std::string, std::vector<double>> measure(const std::string& name, const Accel& accel) {
  const auto metric = Registry::instance().create<Metric>(Registry::instance().ref(Role::metric, name));
  std::map<std::string, std::vector<double>> values;
  for (const MetricValue& value : metric->measure(accel, Scene{}, {})) values[value.name] = value.values;
  return values;
}

TEST(Metrics, ByHand) {
  const Bvh2 bvh = small_tree();
  // Half areas: root 20, leaf of two 12, inner 12, leaves 8 and 8. Eq. 1 with c_T = 3, c_I = 2:
  // (3 · (20 + 12) + 2 · (12 · 2 + 8 + 8)) / 20 = (96 + 80) / 20.
  EXPECT_DOUBLE_EQ(measure("cost", bvh)["cost"][0], 8.8);
  // The inner node's subtree costs 3 · 12 + 2 · (8 + 8) = 68, more than the 2 · 12 · 2 = 48 of a leaf in its place; the root's
  // 3 · 20 + 48 + 48 = 156 is less than the 2 · 20 · 4 = 160 of a single leaf.
  EXPECT_DOUBLE_EQ(measure("ocost", bvh)["ocost"][0], 7.8);
  EXPECT_EQ(measure("nodes", bvh)["nodes"], std::vector{5.0});
  EXPECT_EQ(measure("leaves", bvh)["leaves"], std::vector{3.0});
  EXPECT_EQ(measure("depth", bvh)["depth"], std::vector{2.0});
  EXPECT_DOUBLE_EQ(measure("depth", bvh)["mean_leaf_depth"][0], 5.0 / 3);
  EXPECT_EQ(measure("bytes", bvh)["bytes"], std::vector{6 * 32 + 4 * 4.0});
  auto areas = measure("area-by-depth", bvh);
  EXPECT_THAT(areas["inner_area_by_depth"],
              testing::ElementsAre(testing::DoubleEq(1), testing::DoubleEq(0.6), testing::DoubleEq(0)));
  EXPECT_THAT(areas["leaf_area_by_depth"],
              testing::ElementsAre(testing::DoubleEq(0), testing::DoubleEq(0.6), testing::DoubleEq(0.8)));
}

TEST(Metrics, OfAnEmptyTree) {
  const Bvh2 bvh;
  EXPECT_EQ(measure("cost", bvh)["cost"], std::vector{0.0});
  EXPECT_EQ(measure("ocost", bvh)["ocost"], std::vector{0.0});
  EXPECT_EQ(measure("nodes", bvh)["nodes"], std::vector{0.0});
  EXPECT_EQ(measure("depth", bvh)["mean_leaf_depth"], std::vector{0.0});
  EXPECT_TRUE(measure("area-by-depth", bvh)["inner_area_by_depth"].empty());
}

}  // namespace
}  // namespace raystudy
