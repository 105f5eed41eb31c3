#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "tests/support/twice_area.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Scene soup_of(std::vector<Vec3> vertices) {
  Scene scene;
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i + 2 < vertices.size(); i += 3) triangles.push_back({{i, i + 1, i + 2}});
  scene.vertices = SharedArray<Vec3>(std::move(vertices));
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  return scene;
}

/// Unit right triangles in planes of constant x: boxes of extent (0, 1, 1), half area 1.
Scene plates(const std::vector<float>& xs) {
  std::vector<Vec3> vertices;
  for (const float x : xs) vertices.insert(vertices.end(), {{x, 0, 0}, {x, 1, 0}, {x, 0, 1}});
  return soup_of(std::move(vertices));
}

Scene random_soup(std::size_t n, float scale, float size, unsigned seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random()) / 4294967296.0F; };
  std::vector<Vec3> vertices;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 at{number(), number(), number()};
    for (int k = 0; k < 3; ++k) vertices.push_back((at + Vec3{number(), number(), number()} * size) * scale);
  }
  return soup_of(std::move(vertices));
}

Bvh2 build(std::string_view name, const Scene& scene, const Changes& changes = {}, int threads = 1) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name, changes));
  BuildContext context;
  context.threads = threads;
  const auto accel = builder->build(scene, context);
  return dynamic_cast<const Bvh2&>(*accel);
}

bool same(const Bvh2& a, const Bvh2& b) {
  if (a.nodes.size() != b.nodes.size() || a.triangles != b.triangles) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (a.nodes[i].box != b.nodes[i].box || a.nodes[i].first != b.nodes[i].first || a.nodes[i].count != b.nodes[i].count) {
      return false;
    }
  }
  return true;
}

std::size_t depth_of(const Bvh2& bvh) {
  std::size_t deepest = 0;
  std::vector<std::pair<std::uint32_t, std::size_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [node, depth] = stack.back();
    stack.pop_back();
    deepest = std::max(deepest, depth);
    if (bvh.nodes[node].is_leaf()) continue;
    stack.emplace_back(bvh.nodes[node].first, depth + 1);
    stack.emplace_back(bvh.nodes[node].first + 1, depth + 1);
  }
  return deepest;
}

/// How many triangles lie under the root's left child.
std::size_t left_count(const Bvh2& bvh) {
  std::size_t count = 0;
  std::vector<std::uint32_t> stack{bvh.nodes[0].first};
  while (!stack.empty()) {
    const Bvh2Node& node = bvh.nodes[stack.back()];
    stack.pop_back();
    count += node.count;
    if (!node.is_leaf()) stack.insert(stack.end(), {node.first, node.first + 1});
  }
  return count;
}

struct Variant {
  std::string name;
  Changes changes;
};

std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (const char* leaves : {"single", "sah"}) {
    const ParamValue l = std::string(leaves);
    for (const char* positions : {"box-centers", "centroids", "box-bounds"}) {
      all.push_back({"sweep-sah", {{"leaves", l}, {"positions", std::string(positions)}}});
    }
    all.push_back({"sweep-sah", {{"leaves", l}, {"heuristic", std::string("test-twice-area")}}});
    all.push_back({"binned-sah", {{"leaves", l}}});
    all.push_back({"binned-sah", {{"leaves", l}, {"bins", std::int64_t{5}}, {"heuristic", std::string("test-twice-area")}}});
    all.push_back({"spatial-median", {{"leaves", l}}});
    all.push_back({"object-median", {{"leaves", l}}});
  }
  return all;
}

class EveryVariant : public testing::TestWithParam<Variant> {
 protected:
  void expect_valid(const Scene& scene, std::string_view what) const {
    const Bvh2 bvh = build(GetParam().name, scene, GetParam().changes);
    EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty()) << what;
  }
};

TEST_P(EveryVariant, SurvivesDegenerateInput) {
  EXPECT_TRUE(build(GetParam().name, Scene{}, GetParam().changes).empty());
  for (std::size_t n = 1; n <= 20; ++n) expect_valid(random_soup(n, 1, 0.3F, static_cast<unsigned>(n)), "few triangles");
  expect_valid(plates(std::vector<float>(1000, 2.0F)), "identical triangles");
  expect_valid(random_soup(300, 1e30F, 0.1F, 1), "areas that overflow");
  expect_valid(random_soup(300, 3e38F, 0.1F, 2), "centers that overflow when added");
  expect_valid(random_soup(300, 1e-40F, 0.1F, 3), "denormal coordinates");
  expect_valid(random_soup(300, 1, 0, 4), "triangles of one point");
  std::vector<Vec3> line;
  line.reserve(900);
  for (int i = 0; i < 900; ++i) line.emplace_back(0.0F, static_cast<float>(i * i % 71), 0.0F);
  expect_valid(soup_of(line), "triangles in a line");
  std::vector<Vec3> nested;
  for (int i = 1; i < 120; ++i) {
    const float r = std::ldexp(1.0F, i - 60);
    nested.insert(nested.end(), {{-r, -r, -r}, {r, r, -r}, {0, 0, r}});
  }
  expect_valid(soup_of(nested), "nested boxes");
}

TEST_P(EveryVariant, GetsNoDeeperThanItMustOnEqualBoxes) {
  const Bvh2 bvh = build(GetParam().name, plates(std::vector<float>(5000, 1.0F)), GetParam().changes);
  EXPECT_LE(depth_of(bvh), 30U);
}

TEST_P(EveryVariant, MakesOneTreeWhateverTheThreads) {
  const Scene scene = random_soup(36000, 1, 0.02F, 7);
  const Bvh2 one = build(GetParam().name, scene, GetParam().changes, 1);
  EXPECT_THAT(find_problems(one, scene), testing::IsEmpty());
  for (const int threads : {2, 3}) EXPECT_TRUE(same(one, build(GetParam().name, scene, GetParam().changes, threads))) << threads;
}

std::string text(const Variant& variant) {
  std::string name = variant.name;
  for (const auto& [key, value] : variant.changes) {
    name += '_';
    if (const auto* text = std::get_if<std::string>(&value)) name += *text;
    if (const auto* number = std::get_if<std::int64_t>(&value)) name += std::to_string(*number);
  }
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
std::string variant_name(const testing::TestParamInfo<Variant>& info) { return text(info.param); }
void PrintTo(const Variant& variant, std::ostream* out) { *out << text(variant); }
INSTANTIATE_TEST_SUITE_P(TopDown, EveryVariant, testing::ValuesIn(variants()), variant_name);

// Plates at 0, 1, 2 and 9. Half areas of 1 x 1 plates united over a length l: 1 + 2 l.
// Splits: 1 | 3: 1 + 3 (1 + 16) = 52. 2 | 2: 2 (1 + 2) + 2 (1 + 14) = 36. 3 | 1: 3 (1 + 4) + 1 = 16.
TEST(RootSplit, OfSurfaceAreaPartsTheFarPlate) {
  const Scene scene = plates({9, 0, 2, 1});
  EXPECT_EQ(left_count(build("sweep-sah", scene)), 3U);
  EXPECT_EQ(left_count(build("binned-sah", scene)), 3U);
}

TEST(RootSplit, OfTheSpatialMedianIsAtTheMiddleOfTheBox) {
  EXPECT_EQ(left_count(build("spatial-median", plates({9, 0, 2, 1}))), 3U);  // at 4.5
  EXPECT_EQ(left_count(build("spatial-median", plates({9, 0, 7, 8}))), 1U);
  EXPECT_EQ(left_count(build("spatial-median", plates({5, 5, 5, 5, 5, 5}))), 3U);  // all centers on the plane: the object median
}

TEST(RootSplit, OfTheObjectMedianHalvesTheTriangles) {
  const Bvh2 bvh = build("object-median", plates({9, 0, 2, 1}));
  EXPECT_EQ(left_count(bvh), 2U);
  EXPECT_THAT(std::vector(bvh.triangles.begin(), bvh.triangles.begin() + 2), testing::UnorderedElementsAre(1, 3));
}

// Two bins over centers 0 to 9 part at 4.5; four at 2.25, 4.5 and 6.75. Plates at 0, 3, 4, 9: the best of all splits is 3 | 1
// (3 · 9 + 1 = 28; 1 | 3: 1 + 3 · 13 = 40; 2 | 2: 2 · 7 + 2 · 11 = 36).
TEST(BinnedSah, SplitsOnlyBetweenBins) {
  EXPECT_EQ(left_count(build("binned-sah", plates({0, 3, 4, 9}), {{"bins", std::int64_t{2}}})), 3U);
  // At 0, 4, 5, 9 the one split between two bins is 2 | 2: 2 · 9 + 2 · 9 = 36, though 3 | 1 costs 3 · 11 + 1 = 34.
  EXPECT_EQ(left_count(build("binned-sah", plates({0, 4, 5, 9}), {{"bins", std::int64_t{2}}})), 2U);
  EXPECT_EQ(left_count(build("sweep-sah", plates({0, 4, 5, 9}))), 1U);  // 1 | 3 costs as much as 3 | 1 and is as balanced
}

// A leaf of two plates at 0 costs c_I · 2 = 4; split, 3 + 2 (1 + 1) = 7. At 0 and 9 the box measures 19: 4 · 19 = 76 against
// 3 · 19 + 2 · 2 = 61.
TEST(SahLeaves, EndWhereALeafCostsNoMore) {
  for (const char* name : {"sweep-sah", "binned-sah", "spatial-median", "object-median"}) {
    const Changes sah{{"leaves", std::string("sah")}};
    EXPECT_EQ(build(name, plates({0, 0}), sah).leaf_count(), 1U) << name;
    EXPECT_EQ(build(name, plates({0, 9}), sah).leaf_count(), 2U) << name;
    // Sixteen plates in one place would be one leaf; at most 8 triangles make it two, at most 5 four.
    EXPECT_EQ(build(name, plates(std::vector<float>(16, 1.0F)), sah).leaf_count(), 2U) << name;
    const Changes five{{"leaves", std::string("sah")}, {"max_leaf_triangles", std::int64_t{5}}};
    EXPECT_EQ(build(name, plates(std::vector<float>(16, 1.0F)), five).leaf_count(), 4U) << name;
  }
}

TEST(AnyMeasure, MakesTheTreeOfTheSurfaceAreaWhenItIsTwiceThat) {
  const Scene scene = random_soup(3000, 1, 0.1F, 11);
  for (const char* name : {"sweep-sah", "binned-sah"}) {
    EXPECT_TRUE(same(build(name, scene), build(name, scene, {{"heuristic", std::string("test-twice-area")}}))) << name;
  }
}

}  // namespace
}  // namespace raystudy
