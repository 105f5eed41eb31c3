#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "harness/geometry/morton.h"
#include "harness/method/registry.h"
#include "harness/scene/procedural.h"
#include "harness/vulkan/device.h"

namespace raystudy::gpu {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Bvh2 build(const std::string& name, const Scene& scene, Changes changes = {}, DeviceTimes* times = nullptr) {
  const MethodRef ref = Registry::instance().ref(Role::builder, name, std::move(changes));
  BuildContext context;
  context.device = times;
  const auto accel = Registry::instance().create<Builder>(ref)->build(scene, context);
  return dynamic_cast<const Bvh2&>(*accel);
}

ParamValue number(std::int64_t n) { return n; }

/// Empty where both trees have the same nodes over the same triangles, wherever in memory; else where they first differ.
std::string difference(const Bvh2& a, const Bvh2& b) {
  if (a.nodes.size() != b.nodes.size()) return "numbers of nodes";
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const Bvh2Node& x = a.nodes[i];
    const Bvh2Node& y = b.nodes[j];
    if (x.count != y.count || !(x.box == y.box)) return "nodes " + std::to_string(i) + " and " + std::to_string(j);
    if (!x.is_leaf()) {
      stack.emplace_back(x.first, y.first);
      stack.emplace_back(x.first + 1, y.first + 1);
      continue;
    }
    const auto triangles = [&](const Bvh2& t, const Bvh2Node& node) {
      std::vector<std::uint32_t> all(t.triangles.begin() + node.first, t.triangles.begin() + node.first + node.count);
      std::sort(all.begin(), all.end());
      return all;
    };
    if (triangles(a, x) != triangles(b, y)) return "leaves " + std::to_string(i) + " and " + std::to_string(j);
  }
  return "";
}

class GpuSah : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
};

/// All triangles alike.
Scene heap(std::uint32_t n) {
  Scene scene;
  scene.vertices = SharedArray<Vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  scene.triangles = SharedArray<Triangle>(std::vector<Triangle>(n, Triangle{0, 1, 2}));
  return scene;
}

TEST_F(GpuSah, TakesTheSplitsOfSweepSahWhereThereAreAsManySamplesAsTriangles) {
  for (const char* leaves : {"single", "sah"}) {
    const Changes ours{{"samples", number(1024)}, {"leaves", std::string(leaves)}};
    Changes without_small = ours;
    without_small["small_split"] = number(0);
    for (const char* name : {"soup", "terrain", "city"}) {
      const Scene scene = make_procedural(name, 1000, 1);
      ASSERT_LE(scene.triangles.size(), 1024U);
      const Bvh2 sweep = build("sweep-sah", scene, {{"leaves", std::string(leaves)}});
      EXPECT_EQ(difference(build("gpu-sah", scene, ours), sweep), "") << name << ", " << leaves;
      EXPECT_EQ(difference(build("gpu-sah", scene, without_small), sweep), "") << name << ", " << leaves << ", no small splits";
    }
  }
  const Scene equal = heap(100);
  EXPECT_EQ(difference(build("gpu-sah", equal, {{"samples", number(128)}}), build("sweep-sah", equal)), "");
}

TEST_F(GpuSah, BuildsSmallSubtreesAsItBuildsLargeOnes) {
  for (const char* name : {"soup", "terrain", "city"}) {
    const Scene scene = make_procedural(name, 3000, 1);
    for (const char* leaves : {"single", "sah"}) {
      const Bvh2 none = build("gpu-sah", scene, {{"small_split", number(0)}, {"leaves", std::string(leaves)}});
      for (const std::int64_t size : {2, 3, 32, 64}) {
        const Bvh2 some = build("gpu-sah", scene, {{"small_split", number(size)}, {"leaves", std::string(leaves)}});
        EXPECT_EQ(difference(some, none), "") << name << ", " << leaves << ", " << size;
      }
    }
  }
}

/// What README.md defines, one node after another.
class Reference {
 public:
  Reference(const Scene& scene, std::uint32_t samples, std::uint32_t max_leaf, int lbvh_levels = 0)
      : samples_(samples), max_leaf_(max_leaf) {
    for (const Triangle& triangle : scene.triangles) {
      Box box;
      for (const std::uint32_t v : triangle.vertex) box.extend(scene.vertices[v]);
      boxes_.push_back(box);
    }
    bvh_.nodes.resize(2);
    bvh_.triangles.resize(boxes_.size());
    std::iota(bvh_.triangles.begin(), bvh_.triangles.end(), 0U);
    const auto n = static_cast<std::uint32_t>(boxes_.size());
    const MortonGrid grid(union_of(0, n), 10);
    for (const Box& box : boxes_) cells_.push_back(grid.code(MortonGrid::center(box)) >> static_cast<unsigned>(30 - lbvh_levels));
    std::stable_sort(bvh_.triangles.begin(), bvh_.triangles.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return cells_[a] < cells_[b]; });
    split(0, 0, n);
  }
  [[nodiscard]] const Bvh2& bvh() const { return bvh_; }

 private:
  struct Best {
    float cost = std::numeric_limits<float>::infinity();
    int axis = 3;
    float position = 0;
  };

  [[nodiscard]] static float center(const Box& box, int axis) { return 0.5F * box.lower[axis] + 0.5F * box.upper[axis]; }
  [[nodiscard]] const Box& box_at(std::uint32_t place) const { return boxes_[bvh_.triangles[place]]; }

  [[nodiscard]] Box union_of(std::uint32_t begin, std::uint32_t n) const {
    Box box;
    for (std::uint32_t i = begin; i < begin + n; ++i) box.extend(box_at(i));
    return box;
  }

  void consider(std::uint32_t begin, std::uint32_t n, int axis, float position, Best& best) const {
    Box left;
    Box right;
    std::uint32_t lefts = 0;
    for (std::uint32_t i = begin; i < begin + n; ++i) {
      const bool goes_left = center(box_at(i), axis) <= position;
      (goes_left ? left : right).extend(box_at(i));
      lefts += goes_left ? 1 : 0;
    }
    if (lefts == 0 || lefts == n) return;
    const float cost = left.half_area() * static_cast<float>(lefts) + right.half_area() * static_cast<float>(n - lefts);
    if (cost < best.cost) best = {cost, axis, position};
  }

  [[nodiscard]] Best best_sample(std::uint32_t begin, std::uint32_t n) const {
    Best best;
    for (int axis = 0; axis < 3; ++axis) {
      float lower = std::numeric_limits<float>::infinity();
      float upper = -lower;
      for (std::uint32_t i = begin; i < begin + n; ++i) {
        lower = std::min(lower, center(box_at(i), axis));
        upper = std::max(upper, center(box_at(i), axis));
      }
      for (std::uint32_t s = 0; s < samples_; ++s) {
        const float t = static_cast<float>(s + 1) * (1.0F / static_cast<float>(samples_ + 1));
        consider(begin, n, axis, lower * (1 - t) + upper * t, best);
      }
    }
    return best;
  }

  /// For scenes in which no two centers of a node of few triangles are equal.
  [[nodiscard]] Best best_position(std::uint32_t begin, std::uint32_t n) const {
    Best best;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<float> centers;
      for (std::uint32_t i = begin; i < begin + n; ++i) centers.push_back(center(box_at(i), axis));
      std::sort(centers.begin(), centers.end());
      std::vector<std::uint32_t> order(n - 1);  // the most balanced first
      std::iota(order.begin(), order.end(), 1U);
      std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::abs(static_cast<int>(2 * a) - static_cast<int>(n)) < std::abs(static_cast<int>(2 * b) - static_cast<int>(n));
      });
      for (const std::uint32_t lefts : order) consider(begin, n, axis, centers[lefts - 1], best);
    }
    return best;
  }

  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t n) {
    const Box box = union_of(begin, n);
    bvh_.nodes[node] = {box, begin, n};
    if (n == 1) return;
    const std::uint64_t first_cell = cells_[bvh_.triangles[begin]];
    const std::uint64_t differing = first_cell ^ cells_[bvh_.triangles[begin + n - 1]];
    if (differing != 0) {  // the highest bit
      std::uint32_t lefts = 1;
      while (std::bit_width(first_cell ^ cells_[bvh_.triangles[begin + lefts]]) < std::bit_width(differing)) ++lefts;
      split_at(node, begin, n, lefts);
      return;
    }
    const Best best = n > samples_ ? best_sample(begin, n) : best_position(begin, n);
    const CostModel cost;
    const float area = box.half_area();
    const auto count = static_cast<float>(n);
    if (n <= max_leaf_ && cost.intersection * area * count <= cost.traversal * area + cost.intersection * best.cost) return;
    std::uint32_t lefts = n / 2;
    if (best.axis < 3 && area > 0) {
      const auto first = bvh_.triangles.begin() + begin;
      const auto middle = std::stable_partition(
          first, first + n, [&](std::uint32_t triangle) { return center(boxes_[triangle], best.axis) <= best.position; });
      lefts = static_cast<std::uint32_t>(middle - first);
    }
    split_at(node, begin, n, lefts);
  }

  void split_at(std::uint32_t node, std::uint32_t begin, std::uint32_t n, std::uint32_t lefts) {
    const auto pair = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes.resize(pair + 2);
    bvh_.nodes[node].first = pair;
    bvh_.nodes[node].count = 0;
    split(pair, begin, lefts);
    split(pair + 1, begin + lefts, n - lefts);
  }

  std::uint32_t samples_;
  std::uint32_t max_leaf_;
  std::vector<Box> boxes_;
  std::vector<std::uint64_t> cells_;
  Bvh2 bvh_;
};

TEST_F(GpuSah, BuildsTheTreeOfAPlainImplementation) {
  const Scene soup = make_procedural("soup", 5000, 1);
  for (const std::uint32_t samples : {1U, 5U, 64U}) {
    EXPECT_EQ(difference(build("gpu-sah", soup, {{"samples", number(samples)}}), Reference(soup, samples, 0).bvh()), "")
        << samples;
  }
  const Changes leaves{{"leaves", std::string("sah")}, {"max_leaf_triangles", number(5)}};
  EXPECT_EQ(difference(build("gpu-sah", soup, leaves), Reference(soup, 64, 5).bvh()), "");
}

TEST_F(GpuSah, HalvesWhatNoSampleDivides) {
  const Scene equal = heap(1000);
  EXPECT_EQ(difference(build("gpu-sah", equal, {{"samples", number(1)}}), Reference(equal, 1, 0).bvh()), "");
}

TEST_F(GpuSah, SplitsWithSeveralWorkgroupsWhatIsLarge) {
  const Scene soup = make_procedural("soup", 30'000, 1);
  EXPECT_EQ(difference(build("gpu-sah", soup), Reference(soup, 64, 0).bvh()), "");
  const Scene equal = heap(20'001);
  EXPECT_EQ(difference(build("gpu-sah", equal), Reference(equal, 64, 0).bvh()), "");
}

TEST_F(GpuSah, BeginsAsAnLbvhDoesWhereItIsToldTo) {
  const Scene soup = make_procedural("soup", 30'000, 1);
  for (const int levels : {1, 6, 12}) {
    EXPECT_EQ(difference(build("gpu-sah", soup, {{"lbvh_levels", number(levels)}}), Reference(soup, 64, 0, levels).bvh()), "")
        << levels;
  }
  for (const std::uint32_t n : {1U, 2U, 1000U}) {  // all in one cell
    const Scene equal = heap(n);
    EXPECT_EQ(difference(build("gpu-sah", equal, {{"lbvh_levels", number(6)}}), build("gpu-sah", equal)), "") << n;
  }
}

TEST_F(GpuSah, IsNearlyAsGoodAsSweepSah) {
  for (const char* name : {"terrain", "atrium"}) {
    const Scene scene = make_procedural(name, 20'000, 1);
    const CostModel model;
    EXPECT_LT(tree_cost(build("gpu-sah", scene), model), 1.05 * tree_cost(build("sweep-sah", scene), model)) << name;
  }
}

TEST_F(GpuSah, TellsItsPartsAndLevels) {
  const Scene scene = make_procedural("terrain", 5000, 1);
  const auto n = static_cast<double>(scene.triangles.size());
  DeviceTimes times;
  build("gpu-sah", scene, {}, &times);
  std::vector<std::string> names;
  double sum = 0;
  for (const DeviceTimes::Part& part : times.parts) {
    names.push_back(part.name);
    sum += part.seconds;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"Rest", "SAH split", "Reorder", "Compaction", "Small splits"}));
  EXPECT_NEAR(sum, times.seconds.value(), 1e-9);
  EXPECT_EQ(times.levels.front().active, 1);
  build("gpu-sah", scene, {{"small_split", number(0)}}, &times);
  double splits = 0;
  for (const DeviceTimes::Level& level : times.levels) splits += level.active;
  EXPECT_EQ(splits, n - 1);  // one triangle a leaf
  EXPECT_GT(static_cast<double>(times.peak_bytes), 98 * n);
  EXPECT_LT(static_cast<double>(times.peak_bytes), (98 + 8 + 36) * n);  // with the scene's own
}

}  // namespace
}  // namespace raystudy::gpu
