#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "harness/accel/validate.h"
#include "harness/geometry/morton.h"
#include "harness/method/compaction.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"
#include "tests/support/twice_area.h"

namespace raystudy::lbvh {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Bvh2 build(const std::string& name, const Scene& scene, const Changes& changes = {}, int threads = 1) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name, changes));
  BuildContext context;
  context.threads = threads;
  return dynamic_cast<const Bvh2&>(*builder->build(scene, context));
}

ParamValue text(const char* value) { return std::string(value); }
ParamValue number(std::int64_t value) { return value; }

/// README.md word for word: by recursion, on pointers.
class ByDefinition {
 public:
  ByDefinition(const Scene& scene, int bits, std::uint32_t max_leaf, int sah_bits = 0, std::uint32_t bins = 16)
      : scene_(scene), bits_(bits), max_leaf_(max_leaf), sah_bits_(sah_bits), bins_(bins) {
    Box bounds;
    for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) bounds.extend(scene.triangle_box(t));
    const MortonGrid grid(bounds, bits / 3);
    for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) {
      order_.emplace_back(grid.code(MortonGrid::center(scene.triangle_box(t))), t);
    }
    std::stable_sort(order_.begin(), order_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }

  [[nodiscard]] Bvh2 tree() const {
    std::vector<Node> treelets;
    for (std::size_t begin = 0, end = 0; begin < order_.size(); begin = end) {
      while (end < order_.size() && prefix(end) == prefix(begin)) ++end;
      treelets.push_back(range(begin, end - 1));
    }
    const Node root = over(std::move(treelets));
    Bvh2 bvh;
    bvh.nodes.resize(2 * root.leaves);
    write(root, 0, 0, bvh);
    return bvh;
  }

 private:
  struct Node {
    Box box;
    std::vector<std::uint32_t> triangles;  ///< of a leaf
    std::vector<Node> children;
    std::size_t leaves = 1;
    std::uint32_t count = 0;  ///< of triangles
  };

  [[nodiscard]] std::uint64_t prefix(std::size_t place) const {
    return sah_bits_ == 0 ? 0 : order_[place].first >> static_cast<unsigned>(bits_ - sah_bits_);
  }

  static Node parent(Node left, Node right) {
    Node node{united(left.box, right.box), {}, {}, left.leaves + right.leaves, left.count + right.count};
    node.children = {std::move(left), std::move(right)};
    return node;
  }

  /// Places [a, b].
  [[nodiscard]] Node range(std::size_t a, std::size_t b) const {
    if (b - a + 1 <= max_leaf_) {
      Node leaf;
      for (std::size_t i = a; i <= b; ++i) {
        leaf.box.extend(scene_.triangle_box(order_[i].second));
        leaf.triangles.push_back(order_[i].second);
      }
      leaf.count = static_cast<std::uint32_t>(leaf.triangles.size());
      return leaf;
    }
    const bool by_place = order_[a].first == order_[b].first;
    const auto number = [&](std::size_t i) { return by_place ? i : order_[i].first; };
    const std::uint64_t bit = std::bit_floor(number(a) ^ number(b));
    std::size_t second = a;
    while ((number(second) & bit) == 0) ++second;
    return parent(range(a, second - 1), range(second, b));
  }

  [[nodiscard]] Node over(std::vector<Node> treelets) const {
    if (treelets.size() == 1) return treelets.front();
    Box centers;
    for (const Node& t : treelets) centers.extend(MortonGrid::center(t.box));
    const MortonGrid grid(centers, 16);
    float least = std::numeric_limits<float>::infinity();
    std::vector<bool> best(treelets.size());
    for (std::size_t i = 0; i < treelets.size() / 2; ++i) best[i] = true;
    for (int axis = 0; axis < 3; ++axis) {
      for (std::uint32_t last = 0; last + 1 < bins_; ++last) {
        std::vector<bool> is_left;
        Box boxes[2];
        std::uint32_t counts[2] = {};
        for (const Node& t : treelets) {
          is_left.push_back(grid.cell(MortonGrid::center(t.box), axis) * bins_ / 65536 <= last);
          boxes[is_left.back() ? 0 : 1].extend(t.box);
          counts[is_left.back() ? 0 : 1] += t.count;
        }
        if (counts[0] == 0 || counts[1] == 0) continue;
        const float cost =
            boxes[0].half_area() * static_cast<float>(counts[0]) + boxes[1].half_area() * static_cast<float>(counts[1]);
        if (!(cost < least)) continue;
        least = cost;
        best = is_left;
      }
    }
    std::vector<Node> sides[2];
    for (std::size_t i = 0; i < treelets.size(); ++i) sides[best[i] ? 0 : 1].push_back(std::move(treelets[i]));
    return parent(over(std::move(sides[0])), over(std::move(sides[1])));
  }

  /// `leaf`: the number of the node's first.
  static void write(const Node& node, std::size_t slot, std::size_t leaf, Bvh2& bvh) {
    if (node.children.empty()) {
      bvh.nodes[slot] = {node.box, static_cast<std::uint32_t>(bvh.triangles.size()), node.count};
      bvh.triangles.insert(bvh.triangles.end(), node.triangles.begin(), node.triangles.end());
      return;
    }
    const std::size_t second = leaf + node.children[0].leaves;
    bvh.nodes[slot] = {node.box, static_cast<std::uint32_t>(2 * second), 0};
    write(node.children[0], 2 * second, leaf, bvh);
    write(node.children[1], 2 * second + 1, second, bvh);
  }

  const Scene& scene_;
  int bits_;
  std::uint32_t max_leaf_;
  int sah_bits_;
  std::uint32_t bins_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
};

using test::bar;

/// Boxes of which many share a code, in groups that are not a power of two.
std::vector<Box> heaps(std::size_t count) {
  std::vector<Box> boxes = test::random_boxes(count, count);
  for (std::size_t i = 0; i < count; ++i) boxes[i] = boxes[i * i % std::max<std::size_t>(count / 7, 1)];
  return boxes;
}

TEST(Lbvh, MakesTheTreeOfTheDefinition) {
  for (const std::size_t n : {1, 2, 3, 5, 17, 300, 3000}) {
    for (const std::vector<Box>& boxes : {test::random_boxes(n, n), heaps(n)}) {
      const Scene scene = test::scene_of(boxes);
      for (const int bits : {30, 63}) {
        for (const std::uint32_t leaf : {1U, 2U, 3U, 7U, 8U, 40U}) {
          Changes changes{{"morton_bits", std::to_string(bits)}, {"max_leaf_triangles", number(leaf)}};
          const Bvh2 defined = ByDefinition(scene, bits, leaf).tree();
          for (const char* construction : {"apetrei", "karras"}) {
            changes.insert_or_assign("construction", text(construction));
            EXPECT_TRUE(test::same(build("lbvh", scene, changes), defined))
                << n << " triangles, " << bits << " bits, " << leaf << " a leaf, " << construction;
          }
        }
      }
    }
  }
}

TEST(Hlbvh, MakesTheTreeOfTheDefinition) {
  for (const std::size_t n : {1, 2, 9, 300, 3000}) {
    for (const std::vector<Box>& boxes : {test::random_boxes(n, n + 1), heaps(n)}) {
      const Scene scene = test::scene_of(boxes);
      EXPECT_TRUE(test::same(build("hlbvh", scene, {{"split", text("median")}}), ByDefinition(scene, 30, 8).tree())) << n;
      for (const int bits : {1, 3, 10, 15, 30}) {
        for (const std::uint32_t bins : {2U, 16U, 21U}) {
          const Changes changes{{"sah_bits", number(bits)}, {"bins", number(bins)}};
          EXPECT_TRUE(test::same(build("hlbvh", scene, changes), ByDefinition(scene, 30, 8, bits, bins).tree()))
              << n << " triangles, " << bits << " bits of SAH, " << bins << " bins";
        }
      }
      const Changes changes{{"morton_bits", text("63")}, {"sah_bits", number(40)}, {"max_leaf_triangles", number(1)}};
      EXPECT_TRUE(test::same(build("hlbvh", scene, changes), ByDefinition(scene, 63, 1, 40).tree())) << n;
    }
  }
}

// Cells of 1 along x, 1024 of them; triangles at 0, 1, 2, 2, 1023 (codes of x alone: 0, 1 and 2 in the lowest bits of x).
// The keys of places 0 to 4: x = 0, 1, 2, 2, 1023. The root is split at the bit of 512, between 3 and 4; [0, 3] at the bit of 2,
// between 1 and 2; [0, 1] between 0 and 1; [2, 3] by place, between 2 and 3.
TEST(Lbvh, SplitsByHand) {
  const Scene scene = test::scene_of({bar(1023, 1024), bar(2.25F, 2.5F), bar(1.25F, 1.5F), bar(0, 0.5F), bar(2.5F, 2.75F)});
  const Bvh2 bvh = build("lbvh", scene);
  EXPECT_THAT(bvh.triangles, testing::ElementsAre(3, 2, 1, 4, 0));
  ASSERT_EQ(bvh.nodes.size(), 10U);
  const auto is = [](const Box& box, std::uint32_t first, std::uint32_t count) {
    return testing::AllOf(testing::Field(&Bvh2Node::box, box), testing::Field(&Bvh2Node::first, first),
                          testing::Field(&Bvh2Node::count, count));
  };
  EXPECT_THAT(bvh.nodes[0], is(bar(0, 1024), 8, 0));
  EXPECT_THAT(bvh.nodes[8], is(bar(0, 2.75F), 4, 0));
  EXPECT_THAT(bvh.nodes[9], is(bar(1023, 1024), 4, 1));
  EXPECT_THAT(bvh.nodes[4], is(bar(0, 1.5F), 2, 0));
  EXPECT_THAT(bvh.nodes[5], is(bar(2.25F, 2.75F), 6, 0));
  EXPECT_THAT(bvh.nodes[2], is(bar(0, 0.5F), 0, 1));
  EXPECT_THAT(bvh.nodes[3], is(bar(1.25F, 1.5F), 1, 1));
  EXPECT_THAT(bvh.nodes[6], is(bar(2.25F, 2.5F), 2, 1));
  EXPECT_THAT(bvh.nodes[7], is(bar(2.5F, 2.75F), 3, 1));
}

TEST(Lbvh, ARangeOfNoMoreThanALeafHoldsIsALeaf) {
  const Scene scene = test::scene_of({bar(1023, 1024), bar(2.25F, 2.5F), bar(1.25F, 1.5F), bar(0, 0.5F), bar(2.5F, 2.75F)});
  const Bvh2 bvh = build("lbvh", scene, {{"max_leaf_triangles", number(2)}});
  ASSERT_EQ(bvh.nodes.size(), 6U);
  EXPECT_EQ(bvh.nodes[0].first, 4U);
  EXPECT_EQ(bvh.nodes[2].count, 2U);
  EXPECT_EQ(bvh.nodes[3].count, 2U);
  EXPECT_EQ(bvh.nodes[4].first, 2U);
  EXPECT_EQ(bvh.nodes[5].count, 1U);
  EXPECT_EQ(build("lbvh", scene, {{"max_leaf_triangles", number(4)}}).nodes[2].count, 4U);
  EXPECT_EQ(build("lbvh", scene, {{"max_leaf_triangles", number(1 << 20)}}).nodes.size(), 2U);
}

TEST(Lbvh, SahLeavesAreThoseOfCompaction) {
  const Scene scene = test::scene_of(test::random_boxes(2000, 5));
  Bvh2 compacted = build("lbvh", scene);
  compact(compacted, CostModel{}, 5);
  EXPECT_TRUE(test::same(build("lbvh", scene, {{"leaves", text("sah")}, {"max_leaf_triangles", number(5)}}), compacted));
  EXPECT_LT(compacted.leaf_count(), 2000U);
}

TEST(Lbvh, EqualCodesAreHalvedByPlace) {
  const Scene scene = test::scene_of(std::vector<Box>(21, bar(1, 2)));
  std::vector<std::uint32_t> all(21);
  std::iota(all.begin(), all.end(), 0U);
  for (const char* name : {"lbvh", "hlbvh"}) {
    const Bvh2 bvh = build(name, scene);
    EXPECT_EQ(bvh.triangles, all) << name;
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
  }
  EXPECT_EQ(build("lbvh", scene).nodes[0].first, 32U);  // the bit of 16 parts places 15 and 16
}

TEST(Lbvh, MakesOneTreeWhateverTheThreads) {
  const Scene soup = open_scene("soup", 150000);
  const Scene atrium = open_scene("atrium", 60000);
  const Scene heap = test::scene_of(heaps(100000));
  for (const auto& [name, changes] :
       std::vector<std::pair<std::string, Changes>>{{"lbvh", {}},
                                                    {"lbvh", {{"morton_bits", text("63")}, {"max_leaf_triangles", number(5)}}},
                                                    {"hlbvh", {}},
                                                    {"hlbvh", {{"sah_bits", number(3)}, {"max_leaf_triangles", number(1)}}},
                                                    {"hlbvh", {{"sah_bits", number(30)}}},
                                                    {"hlbvh", {{"split", text("median")}}}}) {
    for (const Scene* scene : {&soup, &atrium, &heap}) {
      const Bvh2 one = build(name, *scene, changes, 1);
      EXPECT_THAT(find_problems(one, *scene), testing::IsEmpty());
      for (const int threads : {2, 3}) EXPECT_TRUE(test::same(one, build(name, *scene, changes, threads))) << name << threads;
    }
  }
}

TEST(Lbvh, TheLargestCoordinatesMakeTheTreeOfTheDefinition) {
  constexpr float most = std::numeric_limits<float>::max();
  std::vector<Box> boxes = test::random_boxes(500, 6);
  for (Box& box : boxes) box = {(min(box.lower, Vec3{1}) * 2 - Vec3{1}) * most, (min(box.upper, Vec3{1}) * 2 - Vec3{1}) * most};
  boxes.emplace_back(Vec3{-most}, Vec3{most});
  const Scene scene = test::scene_of(boxes);
  EXPECT_TRUE(test::same(build("lbvh", scene), ByDefinition(scene, 30, 1).tree()));
  EXPECT_TRUE(test::same(build("hlbvh", scene, {{"sah_bits", number(9)}}), ByDefinition(scene, 30, 8, 9).tree()));
}

TEST(Hlbvh, OfAnyMeasureIsTheTreeOfTheSurfaceAreaWhenItIsTwiceThat) {
  const Scene scene = test::scene_of(test::random_boxes(3000, 4));
  EXPECT_TRUE(test::same(build("hlbvh", scene), build("hlbvh", scene, {{"heuristic", text("test-twice-area")}})));
}

TEST(Hlbvh, TakesNoMoreBitsForSahThanACodeHas) {
  const Scene scene = test::scene_of({bar(0, 1)});
  EXPECT_THAT(
      [&] {
        return build("hlbvh", scene, {{"sah_bits", number(31)}});
      },
      testing::ThrowsMessage<Error>("hlbvh: sah_bits is 31, but codes have 30 bits (morton_bits); expected no more"));
}

}  // namespace
}  // namespace raystudy::lbvh
