// Every builder and every optimizer over every scene: valid trees, no triangle lost, the same for a seed whatever the threads.

#include <gtest/gtest.h>

#include <cstring>

#include "harness/accel/validate.h"
#include "tests/conformance/scenes.h"
#include "tests/conformance/variants.h"

namespace raystudy::test {
namespace {

std::unique_ptr<Accel> build(const MethodRef& builder, const Scene& scene, int threads) {
  BuildContext context;
  context.threads = threads;
  return Registry::instance().create<Builder>(builder)->build(scene, context);
}

std::string problems(const Bvh2& bvh, const Scene& scene) {
  std::string text;
  for (const std::string& problem : find_problems(bvh, scene)) text += problem + "\n";
  return text;
}

/// nodes[1] is padding, whatever it holds.
bool same(const Bvh2& a, const Bvh2& b) {
  if (a.nodes.size() != b.nodes.size() || a.triangles != b.triangles) return false;
  for (std::size_t i = 0; i < a.nodes.size(); ++i) {
    if (i != 1 && std::memcmp(&a.nodes[i], &b.nodes[i], sizeof(Bvh2Node)) != 0) return false;
  }
  return true;
}

class Builders : public testing::TestWithParam<Variant> {};

TEST_P(Builders, MakeWhatTheySay) {
  for (const ConformanceScene& item : conformance_scenes()) {
    SCOPED_TRACE(item.name);
    const auto accel = build(GetParam().ref, item.scene, 1);
    ASSERT_NE(accel, nullptr);
    EXPECT_EQ(accel->kind(), GetParam().accel);
    const auto* bvh = dynamic_cast<const Bvh2*>(accel.get());
    if (bvh == nullptr) continue;
    EXPECT_EQ(problems(*bvh, item.scene), "");
    const auto again = build(GetParam().ref, item.scene, 1);
    EXPECT_TRUE(same(*bvh, dynamic_cast<const Bvh2&>(*again))) << "built twice";
    const auto threaded = build(GetParam().ref, item.scene, 2);
    EXPECT_TRUE(same(*bvh, dynamic_cast<const Bvh2&>(*threaded))) << "built with two threads";
  }
}

class Optimizers : public testing::TestWithParam<Variant> {};

TEST_P(Optimizers, KeepEveryTreeValid) {
  const auto optimizer = Registry::instance().create<Optimizer>(GetParam().ref);
  for (const Variant& builder : variants(Role::builder, true)) {
    if (builder.accel != Bvh2::kind_name) continue;
    for (const ConformanceScene& item : conformance_scenes()) {
      SCOPED_TRACE(builder.label + ", " + item.name);
      const auto built = build(builder.ref, item.scene, 1);
      auto once = dynamic_cast<const Bvh2&>(*built);
      auto twice = once;
      BuildContext context;
      optimizer->optimize(once, item.scene, context);
      EXPECT_EQ(problems(once, item.scene), "");
      context.threads = 2;
      optimizer->optimize(twice, item.scene, context);
      EXPECT_TRUE(same(once, twice)) << "optimized again, with two threads";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conformance, Builders, testing::ValuesIn(variants(Role::builder)), variant_name);
INSTANTIATE_TEST_SUITE_P(Conformance, Optimizers, testing::ValuesIn(variants(Role::optimizer)), variant_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Optimizers);

}  // namespace
}  // namespace raystudy::test
