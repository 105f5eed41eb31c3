#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "harness/accel/tree_walk.h"
#include "harness/accel/validate.h"
#include "harness/geometry/morton.h"
#include "harness/method/compaction.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "methods/ploc/nearest.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"
#include "tests/support/twice_area.h"

namespace raystudy::ploc {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Bvh2 build(const Scene& scene, const Changes& changes = {}, int threads = 1) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, "ploc", changes));
  BuildContext context;
  context.threads = threads;
  return dynamic_cast<const Bvh2&>(*builder->build(scene, context));
}

std::uint32_t depth_of(const Bvh2& bvh) {
  std::uint32_t deepest = 0;
  for_each_node(bvh, [&](const Bvh2Node&, std::uint32_t depth) { deepest = std::max(deepest, depth); });
  return deepest;
}

using test::bar;

/// The algorithm word for word, on pointers: clusters in a list, the list searched to both sides of each.
class Plain {
 public:
  Plain(const Scene& scene, int radius, int bits) : radius_(radius) {
    const auto n = static_cast<std::uint32_t>(scene.triangles.size());
    const MortonGrid grid(scene.bounds, bits / 3);
    std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
    for (std::uint32_t t = 0; t < n; ++t) codes.emplace_back(grid.code(MortonGrid::center(scene.triangle_box(t))), t);
    std::sort(codes.begin(), codes.end());
    for (const auto& [code, t] : codes) {
      list_.push_back(static_cast<int>(nodes_.size()));
      nodes_.push_back({scene.triangle_box(t), -1, -1, t});
    }
    while (list_.size() > 1) round();
  }

  [[nodiscard]] int rounds() const { return rounds_; }

  [[nodiscard]] Bvh2 tree() const {
    Bvh2 bvh;
    bvh.nodes.resize(2);
    write(list_[0], 0, bvh);
    return bvh;
  }

 private:
  struct Node {
    Box box;
    int left;
    int right;
    std::uint32_t triangle;
  };

  [[nodiscard]] std::size_t nearest(std::size_t i) const {
    std::optional<std::size_t> best;
    float least = 0;
    for (std::size_t j = 0; j < list_.size(); ++j) {
      if (j == i || (j > i ? j - i : i - j) > static_cast<std::size_t>(radius_)) continue;
      const float area = united(box(i), box(j)).half_area();
      if (best && (area > least || (area == least && (i ^ j) > (i ^ *best)))) continue;
      best = j;
      least = area;
    }
    return *best;
  }

  [[nodiscard]] const Box& box(std::size_t i) const { return nodes_[static_cast<std::size_t>(list_[i])].box; }

  void round() {
    ++rounds_;
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < list_.size(); ++i) chosen.push_back(nearest(i));
    std::vector<int> next;
    for (std::size_t i = 0; i < list_.size(); ++i) {
      const std::size_t j = chosen[i];
      if (chosen[j] != i) {
        next.push_back(list_[i]);
      } else if (i < j) {
        nodes_.push_back({united(box(i), box(j)), list_[i], list_[j], 0});
        next.push_back(static_cast<int>(nodes_.size()) - 1);
      }
    }
    list_ = next;
  }

  void write(int from, std::uint32_t to, Bvh2& bvh) const {
    const Node& node = nodes_[static_cast<std::size_t>(from)];
    if (node.left < 0) {
      bvh.nodes[to] = {node.box, static_cast<std::uint32_t>(bvh.triangles.size()), 1};
      bvh.triangles.push_back(node.triangle);
      return;
    }
    const auto children = static_cast<std::uint32_t>(bvh.nodes.size());
    bvh.nodes[to] = {node.box, children, 0};
    bvh.nodes.resize(children + 2);
    write(node.left, children, bvh);
    write(node.right, children + 1, bvh);
  }

  int radius_;
  int rounds_ = 0;
  std::vector<Node> nodes_;
  std::vector<int> list_;
};

TEST(Ploc, MakesTheTreeOfThePlainAlgorithm) {
  for (const std::size_t n : {2, 3, 17, 300, 1500}) {
    const Scene scene = test::scene_of(test::random_boxes(n, n));
    for (const int radius : {1, 2, 14, 40}) {
      for (const int bits : {30, 60, 63}) {
        const Changes changes{{"radius", std::int64_t{radius}}, {"morton_bits", std::to_string(bits)}};
        EXPECT_TRUE(test::same(build(scene, changes), Plain(scene, radius, bits).tree()))
            << n << " triangles, radius " << radius << ", " << bits << " bits";
      }
    }
  }
}

// In Morton order A = [0, 1], B = [2, 3], C = [4.5, 5], D = [5.5, 6], E = [9, 10]; nearest are B, A, D, C, D. The first round
// merges AB and CD. Then AB and CD would measure 13, CD and E 12: those are merged, and what is left in the third round.
TEST(Ploc, MergesByHand) {
  const Scene scene = test::scene_of({bar(4.5F, 5), bar(9, 10), bar(0, 1), bar(5.5F, 6), bar(2, 3)});
  const Bvh2 bvh = build(scene);
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(2, 4, 0, 3, 1));
  ASSERT_EQ(bvh.nodes.size(), 10U);
  EXPECT_EQ(bvh.nodes[2].box, bar(0, 3));      // AB
  EXPECT_EQ(bvh.nodes[3].box, bar(4.5F, 10));  // CDE
  EXPECT_EQ(bvh.nodes[6].box, bar(4.5F, 6));   // CD
  EXPECT_EQ(bvh.nodes[7].box, bar(9, 10));     // E
}

TEST(Ploc, LooksNoFartherThanItsRadius) {
  std::vector<float> room(Clusters::room_for(4, 3));
  Clusters clusters(4, 3, room);
  const std::vector<Box> boxes{bar(0, 1), bar(50, 60), bar(2, 3), bar(20, 21)};
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      clusters.row(static_cast<std::size_t>(axis))[i] = boxes[i].lower[axis];
      clusters.row(static_cast<std::size_t>(axis) + 3)[i] = -boxes[i].upper[axis];
    }
  }
  clusters.set_count(4);
  std::vector<std::uint32_t> nearest(search_group);
  find_nearest(SurfaceArea(), clusters, 0, 4, 1, nearest.data());
  EXPECT_THAT(std::vector(nearest.begin(), nearest.begin() + 4), testing::ElementsAre(1, 2, 3, 2));
  find_nearest(SurfaceArea(), clusters, 0, 4, 2, nearest.data());
  EXPECT_THAT(std::vector(nearest.begin(), nearest.begin() + 4), testing::ElementsAre(2, 3, 0, 2));
  const SurfaceArea area;
  std::vector<std::uint32_t> of_any(search_group);
  find_nearest(AnyMeasure(area), clusters, 0, 4, 2, of_any.data());
  EXPECT_TRUE(std::equal(of_any.begin(), of_any.begin() + 4, nearest.begin()));
}

TEST(Ploc, EqualBoxesHalveInEveryRound) {
  for (const std::size_t n : {2, 3, 64, 1000, 1023, 5000}) {
    const Scene scene = test::scene_of(std::vector<Box>(n, bar(1, 2)));
    const auto most = static_cast<std::uint32_t>(std::ceil(std::log2(static_cast<double>(n))));
    for (const char* heuristic : {"surface-area", "test-twice-area"}) {
      EXPECT_EQ(depth_of(build(scene, {{"heuristic", std::string(heuristic)}})), most) << n << ", " << heuristic;
    }
    EXPECT_EQ(Plain(scene, 14, 60).rounds(), static_cast<int>(most));
  }
}

TEST(Ploc, EquallySpacedBoxesMakeNoChain) {
  std::vector<Box> row;
  for (int i = 0; i < 4096; ++i) row.push_back(bar(2 * static_cast<float>(i), 2 * static_cast<float>(i) + 1));
  EXPECT_EQ(depth_of(build(test::scene_of(row))), 12U);
}

TEST(Ploc, MakesOneTreeWhateverTheThreads) {
  const Scene scene = open_scene("atrium", 40000);
  for (const Changes& changes : {Changes{}, Changes{{"morton_bits", std::string("30")}, {"radius", std::int64_t{3}}},
                                 Changes{{"heuristic", std::string("test-twice-area")}, {"leaves", std::string("sah")}}}) {
    const Bvh2 one = build(scene, changes, 1);
    EXPECT_THAT(find_problems(one, scene), testing::IsEmpty());
    for (const int threads : {2, 3}) EXPECT_TRUE(test::same(one, build(scene, changes, threads))) << threads;
  }
}

TEST(Ploc, OfAnyMeasureIsTheTreeOfTheSurfaceAreaWhenItIsTwiceThat) {
  const Scene scene = test::scene_of(test::random_boxes(3000, 4));
  EXPECT_TRUE(test::same(build(scene), build(scene, {{"heuristic", std::string("test-twice-area")}})));
}

TEST(Ploc, SahLeavesAreThoseOfCompaction) {
  const Scene scene = test::scene_of(test::random_boxes(2000, 5));
  Bvh2 compacted = build(scene);
  compact(compacted, CostModel{}, 5);
  EXPECT_TRUE(test::same(build(scene, {{"leaves", std::string("sah")}, {"max_leaf_triangles", std::int64_t{5}}}), compacted));
  EXPECT_LT(compacted.leaf_count(), 2000U);
}

TEST(Ploc, AreasThatOverflowMakeAValidTree) {
  for (const float scale : {1e30F, 3e38F}) {
    std::vector<Box> boxes = test::random_boxes(500, 6);
    for (Box& box : boxes)
      box = {min(box.lower, Vec3{1}) * scale - Vec3{scale / 2}, min(box.upper, Vec3{1}) * scale - Vec3{scale / 2}};
    const Scene scene = test::scene_of(boxes);
    EXPECT_THAT(find_problems(build(scene), scene), testing::IsEmpty());
  }
}

}  // namespace
}  // namespace raystudy::ploc
