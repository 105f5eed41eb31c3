#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "harness/accel/node_order.h"
#include "harness/accel/tree_walk.h"
#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

constexpr NodeOrder all_orders[] = {NodeOrder::preorder, NodeOrder::larger_first, NodeOrder::by_area, NodeOrder::van_emde_boas};

/// A complete tree over 2^levels bars, breadth first: node k's children are 2 k and 2 k + 1 of the usual numbering from 1.
Bvh2 complete_tree(std::uint32_t levels) {
  Bvh2 bvh;
  const std::uint32_t leaves = 1U << levels;
  bvh.nodes.resize(2 * leaves);
  const auto slot = [](std::uint32_t k) { return k == 1 ? 0 : k; };  // nodes[k] for k > 1: siblings 2 k, 2 k + 1 are a pair
  for (std::uint32_t k = 2 * leaves - 1; k > 0; --k) {
    Bvh2Node& node = bvh.nodes[slot(k)];
    if (k >= leaves) {
      const auto x = static_cast<float>(k - leaves);
      node = test::leaf(test::bar(x, x + 1), k - leaves);
      bvh.triangles.push_back(k - leaves);
    } else {
      node = test::inner(united(bvh.nodes[2 * k].box, bvh.nodes[2 * k + 1].box), 2 * k);
    }
  }
  std::sort(bvh.triangles.begin(), bvh.triangles.end());
  return bvh;
}

/// The inner nodes in the order in which the pairs of their children lie, by the first bar and the number of bars below them.
std::vector<std::pair<int, int>> order_of(const Bvh2& bvh) {
  std::vector<std::pair<std::uint32_t, std::pair<int, int>>> pairs;
  for_each_node(bvh, [&](const Bvh2Node& node, std::uint32_t) {
    if (!node.is_leaf()) {
      pairs.push_back({node.first, {static_cast<int>(node.box.lower.x), static_cast<int>(node.box.extent().x)}});
    }
  });
  std::sort(pairs.begin(), pairs.end());
  std::vector<std::pair<int, int>> order;
  for (const auto& [first, name] : pairs) order.push_back(name);
  return order;
}

// Eight bars: the root (0, 8), its children (0, 4) and (4, 4), and theirs. With the padding above the root there are four levels
// of units: van Emde Boas takes the upper two (the root's pair), then from each pair below two levels.
TEST(NodeOrder, ByHand) {
  const Bvh2 tree = complete_tree(3);
  const auto ordered = [&](NodeOrder order) {
    Bvh2 copy = tree;
    arrange(copy, order, Pages::huge);
    return order_of(copy);
  };
  using testing::ElementsAre;
  using testing::Pair;
  EXPECT_THAT(order_of(tree), ElementsAre(Pair(0, 8), Pair(0, 4), Pair(4, 4), Pair(0, 2), Pair(2, 2), Pair(4, 2), Pair(6, 2)));
  EXPECT_THAT(ordered(NodeOrder::preorder),
              ElementsAre(Pair(0, 8), Pair(0, 4), Pair(0, 2), Pair(2, 2), Pair(4, 4), Pair(4, 2), Pair(6, 2)));
  EXPECT_THAT(ordered(NodeOrder::by_area),
              ElementsAre(Pair(0, 8), Pair(0, 4), Pair(4, 4), Pair(0, 2), Pair(2, 2), Pair(4, 2), Pair(6, 2)));
  EXPECT_THAT(ordered(NodeOrder::van_emde_boas),
              ElementsAre(Pair(0, 8), Pair(0, 4), Pair(0, 2), Pair(2, 2), Pair(4, 4), Pair(4, 2), Pair(6, 2)));
}

// Thirty-two bars, six levels of units: the upper three are the padding, the root's pair and its children's; then come the three
// levels below each of four nodes, the upper one of these first.
TEST(NodeOrder, VanEmdeBoasOfSixLevelsByHand) {
  Bvh2 tree = complete_tree(5);
  arrange(tree, NodeOrder::van_emde_boas, Pages::huge);
  const auto order = order_of(tree);
  using testing::Pair;
  ASSERT_EQ(order.size(), 31U);
  EXPECT_THAT(std::vector(order.begin(), order.begin() + 9),
              testing::ElementsAre(Pair(0, 32), Pair(0, 16), Pair(16, 16), Pair(0, 8), Pair(0, 4), Pair(0, 2), Pair(2, 2),
                                   Pair(4, 4), Pair(4, 2)));
}

TEST(NodeOrder, LargerFirstDescendsIntoTheLargerChild) {
  Bvh2 bvh;  // root (A = [0, 2], B = [2, 9]), both of two leaves
  using test::bar;
  using test::inner;
  using test::leaf;
  bvh.nodes = {inner(bar(0, 9), 2), {},
               inner(bar(0, 2), 4), inner(bar(2, 9), 6),
               leaf(bar(0, 1), 0),  leaf(bar(1, 2), 1),
               leaf(bar(2, 3), 2),  leaf(bar(3, 9), 3)};
  bvh.triangles = {0, 1, 2, 3};
  arrange(bvh, NodeOrder::larger_first, Pages::huge);
  EXPECT_THAT(order_of(bvh), testing::ElementsAre(testing::Pair(0, 9), testing::Pair(2, 7), testing::Pair(0, 2)));
  EXPECT_EQ(bvh.nodes[2].box, bar(0, 2));  // siblings keep their sides
}

TEST(NodeOrder, KeepsTheTree) {
  for (const std::size_t n : {0, 1, 2, 3, 700}) {
    const Scene scene = test::scene_of(test::random_boxes(n, n + 1));
    const Bvh2 random = test::random_tree(scene, n, 2);
    Bvh2 tree = random;
    arrange(tree, NodeOrder::preorder, Pages::huge);
    for (const NodeOrder order : all_orders) {
      for (const Pages pages : {Pages::huge, Pages::normal}) {
        Bvh2 moved = random;
        arrange(moved, order, pages);
        EXPECT_EQ(tree_cost(moved, {}), tree_cost(tree, {}));  // bit for bit
        if (n > 0) {
          EXPECT_THAT(find_problems(moved, scene), testing::IsEmpty());
        }
        for (std::uint32_t i = 0; i < moved.nodes.size(); ++i) {
          EXPECT_TRUE(i == 1 || moved.nodes[i].is_leaf() || moved.nodes[i].first > i) << "parents first";
        }
        arrange(moved, NodeOrder::preorder, Pages::huge);
        EXPECT_TRUE(test::same(moved, tree));
      }
    }
  }
}

TEST(NodeOrder, ByAreaDescends) {
  const Scene scene = test::scene_of(test::random_boxes(500, 9));
  Bvh2 tree = test::random_tree(scene, 9);
  arrange(tree, NodeOrder::by_area, Pages::huge);
  std::vector<std::pair<std::uint32_t, float>> around;
  for_each_node(tree, [&](const Bvh2Node& node, std::uint32_t) {
    if (!node.is_leaf()) around.emplace_back(node.first, node.box.half_area());
  });
  std::sort(around.begin(), around.end());
  EXPECT_TRUE(std::is_sorted(around.begin(), around.end(), [](const auto& a, const auto& b) { return a.second > b.second; }));
}

TEST(NodeOrder, OfAWideTreeKeepsTheTree) {
  const Scene scene = test::scene_of(test::random_boxes(900, 3));
  const Bvh2 bvh = test::random_tree(scene, 3);
  using Changes = std::map<std::string, ParamValue, std::less<>>;
  const auto encode = [&](const char* encoder, Changes changes) {
    const Registry& registry = Registry::instance();
    const auto accel = registry.create<Encoder>(registry.ref(Role::encoder, encoder, std::move(changes)))->encode(bvh, scene, {});
    return dynamic_cast<const WideBvh&>(*accel);
  };
  for (const char* encoder : {"bvh4", "bvh8", "bvh16"}) {
    for (const std::string boxes : {"float", "8-bit"}) {
      const WideBvh tree = encode(encoder, {{"boxes", boxes}});
      for (const std::string& layout : node_order_names()) {
        WideBvh moved = encode(encoder, {{"boxes", boxes}, {"layout", layout}, {"pages", std::string("normal")}});
        EXPECT_THAT(find_problems(moved, scene), testing::IsEmpty());
        EXPECT_EQ(tree_cost(moved, {}), tree_cost(tree, {}));
        if (layout == "by-area" || layout == "van-emde-boas") {
          EXPECT_FALSE(test::same(moved, tree)) << encoder << ", " << layout;
        }
        arrange(moved, NodeOrder::preorder, Pages::huge);
        EXPECT_TRUE(test::same(moved, tree)) << encoder << ", " << boxes << ", " << layout;
      }
    }
  }
}

}  // namespace
}  // namespace raystudy
