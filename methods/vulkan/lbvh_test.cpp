#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "harness/accel/validate.h"
#include "harness/base/error.h"
#include "harness/geometry/morton.h"
#include "harness/method/registry.h"
#include "harness/scene/open.h"
#include "harness/vulkan/device.h"
#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/lbvh_tree.h"
#include "methods/vulkan/ploc_tree.h"
#include "methods/vulkan/treelet_tree.h"
#include "tests/support/same_tree.h"
#include "tests/support/trees.h"

namespace raystudy::gpu {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

Bvh2 build(const std::string& name, const Scene& scene, const Changes& changes, DeviceTimes* times = nullptr) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name, changes));
  BuildContext context;
  context.device = times;
  return dynamic_cast<const Bvh2&>(*builder->build(scene, context));
}

/// The definition of methods/lbvh/README.md word for word, by recursion.
class Plain {
 public:
  Plain(const Scene& scene, int bits, std::uint32_t max_leaf) : scene_(scene), max_leaf_(max_leaf) {
    const auto n = static_cast<std::uint32_t>(scene.triangles.size());
    const MortonGrid grid(scene.bounds, bits / 3);
    for (std::uint32_t t = 0; t < n; ++t) keys_.emplace_back(grid.code(MortonGrid::center(scene.triangle_box(t))), t);
    std::sort(keys_.begin(), keys_.end());
    for (const auto& [code, t] : keys_) bvh_.triangles.push_back(t);
    split(0, n, root_);
    bvh_.nodes.resize(2 * std::size_t{leaves_});
    write(root_, 0);
  }

  [[nodiscard]] const Bvh2& tree() const { return bvh_; }

 private:
  struct Node {
    Box box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
    std::uint32_t last_leaf_of_left = 0;
    std::vector<Node> children{};
  };

  void split(std::uint32_t begin, std::uint32_t end, Node& node) {
    if (end - begin <= max_leaf_) {
      for (std::uint32_t p = begin; p < end; ++p) node.box.extend(scene_.triangle_box(bvh_.triangles[p]));
      node.first = begin;
      node.count = end - begin;
      ++leaves_;
      return;
    }
    const std::uint64_t codes = keys_[begin].first ^ keys_[end - 1].first;
    const auto second = [&](std::uint32_t p) {  // whether p has the highest differing bit
      return codes != 0 ? (keys_[p].first & std::bit_floor(codes)) != 0 : (p & std::bit_floor(begin ^ (end - 1))) != 0;
    };
    std::uint32_t middle = begin;
    while (!second(middle)) ++middle;
    node.children.resize(2);
    split(begin, middle, node.children[0]);
    node.last_leaf_of_left = leaves_ - 1;
    split(middle, end, node.children[1]);
    node.box = united(node.children[0].box, node.children[1].box);
  }

  void write(const Node& node, std::uint32_t slot) {
    const std::uint32_t pair = 2 * node.last_leaf_of_left + 2;
    bvh_.nodes[slot] = {node.box, node.count > 0 ? node.first : pair, node.count};
    for (std::uint32_t side = 0; side < node.children.size(); ++side) write(node.children[side], pair + side);
  }

  const Scene& scene_;
  std::uint32_t max_leaf_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys_;
  std::uint32_t leaves_ = 0;
  Node root_;
  Bvh2 bvh_;
};

class DeviceLbvh : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
};

void check_all(const Scene& scene) {
  for (const int bits : {30, 63}) {
    for (const std::int64_t max_leaf : {1, 2, 8}) {
      const Plain plain(scene, bits, static_cast<std::uint32_t>(max_leaf));
      for (const char* construction : {"karras", "apetrei"}) {
        const Bvh2 bvh = build("gpu-lbvh", scene,
                               {{"morton_bits", std::to_string(bits)},
                                {"max_leaf_triangles", max_leaf},
                                {"construction", std::string(construction)}});
        EXPECT_TRUE(test::same(bvh, plain.tree()))
            << scene.triangles.size() << " triangles, " << bits << " bits, leaves of " << max_leaf << ", " << construction;
        EXPECT_THAT(find_problems(bvh, scene), testing::IsEmpty());
      }
    }
  }
}

TEST_F(DeviceLbvh, IsTheTreeOfTheDefinition) {
  for (const std::size_t n : {1, 2, 3, 9, 64, 65, 1000, 5000}) check_all(test::scene_of(test::random_boxes(n, n)));
}

TEST_F(DeviceLbvh, OfEqualCodesIsSplitByPlaces) {
  for (const std::size_t n : {2, 3, 100, 2500}) check_all(test::scene_of(std::vector<Box>(n, test::bar(1, 2))));
}

TEST_F(DeviceLbvh, OfHugeAndTinyCoordinates) {
  for (const float scale : {1e38F, 1e-30F}) {
    std::vector<Box> boxes = test::random_boxes(400, 3);
    for (Box& box : boxes) box = {box.lower * scale, box.upper * scale};
    check_all(test::scene_of(boxes));
  }
}

TEST_F(DeviceLbvh, OfAScene) { check_all(open_scene("atrium", 20000)); }

/// What the builders are made of, in another shape than the device's own.
struct Shaped {
  Shaped(const Scene& scene, std::uint32_t bits, const DeviceShape& shape)
      : on_device(device, scene), order(device, on_device, bits, shape), parts(order.build()) {}

  Bvh2 download(const vulkan::Slice& nodes, std::uint32_t leaves, const vulkan::Slice& triangles) {
    Bvh2 bvh;
    download_tree(device, nodes, leaves, triangles, order.count(), bvh);
    return bvh;
  }

  vulkan::Device& device = vulkan::Device::shared();
  DeviceScene on_device;
  MortonOrder order;
  std::vector<vulkan::PartTime> parts;
};

TEST_F(DeviceLbvh, IsTheSameWhateverTheShapeOfTheWork) {
  const Scene scene = open_scene("atrium", 20000);
  const DeviceShape usual = shape_of(vulkan::Device::shared());
  for (DeviceShape shape : {gpu_shape(), processor_shape(vulkan::Device::shared().info())}) {
    shape.fences = usual.fences;
    for (const std::int64_t max_leaf : {1, 8}) {
      Shaped s(scene, 30, shape);
      LbvhLeaves leaves(s.device, s.order, static_cast<std::uint32_t>(max_leaf));
      leaves.find(s.parts);
      LbvhTree tree(s.device, leaves, Construction::karras);
      tree.build(s.parts);
      EXPECT_TRUE(test::same(s.download(tree.nodes(), leaves.count(), s.order.order()),
                             build("gpu-lbvh", scene, {{"max_leaf_triangles", max_leaf}})));
    }
    {
      Shaped s(scene, 30, shape);
      const std::uint32_t depth = depth_of_prefix(30, 15);
      LbvhLeaves leaves(s.device, s.order, 8, depth);
      leaves.find(s.parts);
      TreeletTree tree(s.device, leaves, depth, 16);
      tree.build(s.parts);
      EXPECT_TRUE(test::same(s.download(tree.nodes(), leaves.count(), tree.triangles()), build("gpu-hlbvh", scene, {})));
    }
    Shaped s(scene, 60, shape);
    PlocTree tree(s.device, s.order, 14);
    tree.build(s.parts);
    EXPECT_TRUE(test::same(s.download(tree.nodes(), s.order.count(), tree.triangles()), build("gpu-ploc", scene, {})));
  }
}

TEST_F(DeviceLbvh, SaysHowManyTreeletsAProcessorSplits) {
  const vulkan::DeviceInfo& info = vulkan::Device::shared().info();
  if (info.type != "cpu") GTEST_SKIP() << info.name << " is no processor";
  const Scene scene = test::scene_of(test::random_boxes(140'000, 1));
  EXPECT_THAT(
      [&] {
        build("gpu-hlbvh", scene, {{"morton_bits", std::string("63")}, {"sah_bits", std::int64_t{63}}});
      },
      testing::ThrowsMessage<Error>("140000 treelets are more than " + info.name +
                                    " splits; expected 131072 at most: use fewer sah_bits"));
}

TEST_F(DeviceLbvh, OfNoTrianglesHasNoNodes) { EXPECT_TRUE(build("gpu-lbvh", Scene(), {}).empty()); }

TEST_F(DeviceLbvh, TreeletsCannotShareMoreBitsThanThereAre) {
  EXPECT_THAT(
      [] {
        build("gpu-hlbvh", Scene(), {{"sah_bits", std::int64_t{31}}});
      },
      testing::ThrowsMessage<Error>("gpu-hlbvh: sah_bits is 31, but codes have 30 bits (morton_bits); expected no more"));
}

TEST_F(DeviceLbvh, TellsItsTimes) {
  DeviceTimes times;
  static_cast<void>(build("gpu-lbvh", test::scene_of(test::random_boxes(1000, 1)), {}, &times));
  std::vector<std::string> names;
  double sum = 0;
  for (const DeviceTimes::Part& part : times.parts) {
    names.push_back(part.name);
    sum += part.seconds;
  }
  EXPECT_THAT(names, testing::ElementsAre("bounds", "morton", "sort", "leaves", "hierarchy", "boxes"));
  EXPECT_DOUBLE_EQ(times.seconds.value_or(0), sum);
  EXPECT_GT(sum, 0);
  EXPECT_GT(times.upload, 0);
  EXPECT_GT(times.download, 0);
  EXPECT_GT(times.peak_bytes, 1000 * (sizeof(Box) + 2 * sizeof(Bvh2Node)));
}

}  // namespace
}  // namespace raystudy::gpu
