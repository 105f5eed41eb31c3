// Every builder, optimizer and encoder over every scene: valid trees, no triangle lost, the same for a seed whatever the threads.

#include <gtest/gtest.h>

#include "harness/accel/validate.h"
#include "tests/conformance/scenes.h"
#include "tests/conformance/variants.h"
#include "tests/support/same_tree.h"

namespace raystudy::test {
namespace {

std::unique_ptr<Accel> build(const MethodRef& builder, const Scene& scene, int threads) {
  BuildContext context;
  context.threads = threads;
  return Registry::instance().create<Builder>(builder)->build(scene, context);
}

std::string problems(const Accel& accel, const Scene& scene) {
  std::string text;
  for (const std::string& problem : find_problems(accel, scene)) text += problem + "\n";
  return text;
}

class Builders : public testing::TestWithParam<Variant> {};

TEST_P(Builders, MakeWhatTheySay) {
  if (const std::string why = why_not_here(GetParam()); !why.empty()) GTEST_SKIP() << why;
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

class Encoders : public testing::TestWithParam<Variant> {};

TEST_P(Encoders, MakeWhatTheySayOfEveryTree) {
  const auto encoder = Registry::instance().create<Encoder>(GetParam().ref);
  for (const Variant& builder : variants(Role::builder, true)) {
    if (builder.accel != Bvh2::kind_name) continue;
    for (const ConformanceScene& item : conformance_scenes()) {
      SCOPED_TRACE(builder.label + ", " + item.name);
      const auto built = build(builder.ref, item.scene, 1);
      const auto& bvh = dynamic_cast<const Bvh2&>(*built);
      BuildContext context;
      const auto encoded = encoder->encode(bvh, item.scene, context);
      ASSERT_NE(encoded, nullptr);
      EXPECT_EQ(encoded->kind(), GetParam().accel);
      EXPECT_EQ(problems(*encoded, item.scene), "");
      const auto* wide = dynamic_cast<const WideBvh*>(encoded.get());
      if (wide == nullptr) continue;
      EXPECT_EQ(wide->duplicates, bvh.duplicates);
      EXPECT_TRUE(same(*wide, dynamic_cast<const WideBvh&>(*encoder->encode(bvh, item.scene, context)))) << "encoded twice";
      context.threads = 2;
      EXPECT_TRUE(same(*wide, dynamic_cast<const WideBvh&>(*encoder->encode(bvh, item.scene, context)))) << "with two threads";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conformance, Builders, testing::ValuesIn(variants(Role::builder)), variant_name);
INSTANTIATE_TEST_SUITE_P(Conformance, Optimizers, testing::ValuesIn(variants(Role::optimizer)), variant_name);
INSTANTIATE_TEST_SUITE_P(Conformance, Encoders, testing::ValuesIn(variants(Role::encoder)), variant_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Optimizers);

}  // namespace
}  // namespace raystudy::test
