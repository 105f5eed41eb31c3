// Builders on a device against their twins on the processor: the same trees, node by node, of small scenes in every variant and
// of every scene of the catalog that is at hand.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "harness/method/registry.h"
#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"
#include "harness/vulkan/device.h"
#include "tests/support/test_name.h"
#include "tests/support/trees.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

struct Twins {
  std::string device;
  std::string processor;
  Changes changes{};
};

/// With their defaults.
std::vector<Twins> plain_twins() {
  return {{"gpu-lbvh", "lbvh"},
          {"gpu-hlbvh", "hlbvh"},
          {"gpu-hlbvh", "hlbvh", {{"split", std::string("median")}}},
          {"gpu-ploc", "ploc"}};
}

std::vector<Twins> all_twins() {
  const Changes bits63{{"morton_bits", std::string("63")}};
  const Changes median{{"split", std::string("median")}};
  const Changes few_bits{{"sah_bits", std::int64_t{6}}, {"bins", std::int64_t{5}}, {"max_leaf_triangles", std::int64_t{1}}};
  const Changes all_bits{{"sah_bits", std::int64_t{30}}, {"max_leaf_triangles", std::int64_t{3}}};
  return {{"gpu-ploc", "ploc"},
          {"gpu-ploc", "ploc", {{"morton_bits", std::string("30")}, {"radius", std::int64_t{3}}}},
          {"gpu-ploc", "ploc", {{"morton_bits", std::string("63")}, {"radius", std::int64_t{40}}}},
          {"gpu-lbvh", "lbvh"},
          {"gpu-lbvh", "lbvh", bits63},
          {"gpu-lbvh", "lbvh", {{"construction", std::string("apetrei")}}},
          {"gpu-hlbvh", "hlbvh"},
          {"gpu-hlbvh", "hlbvh", bits63},
          {"gpu-hlbvh", "hlbvh", median},
          {"gpu-hlbvh", "hlbvh", few_bits},
          {"gpu-hlbvh", "hlbvh", all_bits}};
}

Bvh2 build(const std::string& name, const Changes& changes, const Scene& scene) {
  const auto builder = Registry::instance().create<Builder>(Registry::instance().ref(Role::builder, name, changes));
  BuildContext context;
  context.threads = 2;
  return dynamic_cast<const Bvh2&>(*builder->build(scene, context));
}

/// Where coordinates are zeros of either sign, which of them is a bound may differ.
bool agree(const Bvh2& a, const Bvh2& b) {
  if (a.nodes.size() != b.nodes.size() || a.triangles != b.triangles) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (i == 1) continue;
    if (a.nodes[i].first != b.nodes[i].first || a.nodes[i].count != b.nodes[i].count || a.nodes[i].box != b.nodes[i].box)
      return false;
  }
  return true;
}

void compare(const Scene& scene, const std::vector<Twins>& twins) {
  for (const Twins& pair : twins) {
    EXPECT_TRUE(agree(build(pair.device, pair.changes, scene), build(pair.processor, pair.changes, scene)))
        << scene.name << ", " << canonical(Registry::instance().ref(Role::builder, pair.device, pair.changes));
  }
}

class DeviceTwins : public testing::Test {
 protected:
  void SetUp() override {
    if (vulkan::list_devices().empty()) GTEST_SKIP() << "there is no Vulkan device on this machine";
  }
};

TEST_F(DeviceTwins, OfBoxes) {
  for (const std::size_t n : {1, 2, 7, 100, 3000}) {
    compare(test::scene_of(test::random_boxes(n, n)), all_twins());
    compare(test::scene_of(std::vector<Box>(n, test::bar(1, 2))), all_twins());
  }
}

TEST_F(DeviceTwins, OfProceduralScenes) {
  for (const ProceduralInfo& info : procedural_scenes()) compare(make_procedural(info.name, 5000, 1), all_twins());
}

class CatalogTwins : public DeviceTwins, public testing::WithParamInterface<std::string> {};

TEST_P(CatalogTwins, BuildTheSameTrees) {
  try {
    compare(open_scene(GetParam()), plain_twins());
  } catch (const SceneNotInstalled& missing) {
    GTEST_SKIP() << missing.what();
  }
}

std::vector<std::string> catalog_names() {
  std::vector<std::string> names;
  for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) names.push_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, CatalogTwins, testing::ValuesIn(catalog_names()), test::test_name);

}  // namespace
}  // namespace raystudy
