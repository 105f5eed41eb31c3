// What every method says of itself, every workload, every metric and every heuristic.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "harness/geometry/sampling.h"
#include "tests/conformance/scenes.h"
#include "tests/conformance/variants.h"
#include "tests/support/brute_force.h"

namespace raystudy::test {
namespace {

TEST(Methods, SayWhatTheyAre) {
  Registry::instance().require_no_conflicts();
  for (const Registry::Entry* entry : Registry::instance().entries()) {
    const MethodInfo& info = entry->info;
    SCOPED_TRACE(std::string(role_name(entry->role)) + " " + info.name);
    EXPECT_THAT(info.name, testing::MatchesRegex("[a-z][a-z0-9]*(-[a-z0-9]+)*"));
    EXPECT_NE(info.summary, "");
    EXPECT_EQ(info.summary.find('\n'), std::string::npos);
    EXPECT_NE(info.citation, "");
    if (entry->role == Role::builder || entry->role == Role::encoder || entry->role == Role::tracer) {
      EXPECT_NE(info.accel, "");
    }
    if (entry->role == Role::metric) {
      EXPECT_FALSE(info.values.empty());
    }
    std::set<std::string> names;
    for (const ParamSpec& param : info.params) {
      EXPECT_TRUE(names.insert(param.name).second) << param.name;
      EXPECT_NE(param.summary, "") << param.name;
      // A `method` parameter's default is resolved by name.
      if (param.type != ParamType::method) {
        EXPECT_NO_THROW((void)checked(param, param.fallback)) << param.name;
      }
    }
    ASSERT_NO_THROW((void)Registry::instance().ref(entry->role, info.name));
    const MethodRef ref = Registry::instance().ref(entry->role, info.name);
    EXPECT_NE(entry->make(*ref.params), nullptr);
    EXPECT_EQ(ref.params->values().size(), info.params.size());
  }
}

/// The workload's defaults with its counts brought down, so that it makes thousands of rays and not millions.
MethodRef small(const MethodRef& ref) {
  std::map<std::string, ParamValue, std::less<>> values = ref.params->values();
  for (const auto& [name, most] : {std::pair{"width", 24}, {"height", 16}, {"count", 1000}, {"rays", 3}}) {
    const auto value = values.find(name);
    if (value != values.end()) value->second = std::min(std::get<std::int64_t>(value->second), std::int64_t{most});
  }
  return Registry::instance().ref(Role::workload, ref.name, std::move(values));
}

bool same(const Ray& a, const Ray& b) {
  return a.origin == b.origin && a.direction == b.direction && a.tmin == b.tmin && a.tmax == b.tmax;
}

class Workloads : public testing::TestWithParam<Variant> {};

TEST_P(Workloads, AreRepeatableAndWellFormed) {
  const auto workload = Registry::instance().create<Workload>(small(GetParam().ref));
  for (const ConformanceScene& item : conformance_scenes()) {
    if (item.scene.triangles.empty()) continue;
    SCOPED_TRACE(item.name);
    const WorkloadContext context{5, [&](auto rays, auto hits) { closest_hits(item.scene, rays, hits); }};
    const RayBatch batch = workload->generate(item.scene, context);
    const RayBatch again = workload->generate(item.scene, context);
    ASSERT_EQ(batch.rays.size(), again.rays.size());
    EXPECT_TRUE(std::equal(batch.rays.begin(), batch.rays.end(), again.rays.begin(), same));
    EXPECT_EQ(batch.ray_pixels, again.ray_pixels);
    if (!batch.ray_pixels.empty()) {
      EXPECT_EQ(batch.ray_pixels.size(), batch.rays.size());
      for (const std::uint32_t pixel : batch.ray_pixels) ASSERT_LT(pixel, batch.width * batch.height);
    }
    for (const Ray& ray : batch.rays) {
      ASSERT_TRUE(is_finite(ray.origin) && is_finite(ray.direction));
      ASSERT_TRUE(ray.tmin >= 0 && ray.tmin <= ray.tmax);
    }
  }
}

class Metrics : public testing::TestWithParam<Variant> {};

TEST_P(Metrics, GiveFiniteValuesAsTheySay) {
  const Registry& registry = Registry::instance();
  const auto metric = registry.create<Metric>(GetParam().ref);
  const MethodInfo& info = registry.get(Role::metric, GetParam().ref.name).info;
  const BuildContext context;
  for (const Variant& builder : variants(Role::builder, true)) {
    if (!info.accel.empty() && info.accel != builder.accel) continue;
    for (const ConformanceScene& item : conformance_scenes()) {
      SCOPED_TRACE(builder.label + ", " + item.name);
      const auto accel = registry.create<Builder>(builder.ref)->build(item.scene, context);
      for (const MetricValue& value : metric->measure(*accel, item.scene, context)) {
        const auto declared =
            std::find_if(info.values.begin(), info.values.end(), [&](const MetricValueInfo& v) { return v.name == value.name; });
        ASSERT_NE(declared, info.values.end()) << value.name;
        EXPECT_EQ(declared->unit, value.unit);
        EXPECT_EQ(declared->axis, value.x);
        if (value.x.empty()) {
          EXPECT_EQ(value.values.size(), 1U);
        }
        for (const double v : value.values) ASSERT_TRUE(std::isfinite(v)) << value.name << " = " << v;
      }
    }
  }
}

class Heuristics : public testing::TestWithParam<Variant> {};

TEST_P(Heuristics, GrowWithTheBox) {
  const auto heuristic = Registry::instance().create<Heuristic>(GetParam().ref);
  const IndexedRandom random(3, 0);
  for (const ConformanceScene& item : conformance_scenes()) {
    if (item.scene.triangles.empty()) continue;
    SCOPED_TRACE(item.name);
    const auto measure = heuristic->prepare(item.scene, {});
    std::vector<Box> boxes{Box{}};
    for (std::uint64_t i = 0; i < 200; ++i) {
      const auto t = static_cast<std::uint32_t>(random.bits(i) % item.scene.triangles.size());
      boxes.push_back(i % 10 == 0 ? item.scene.triangle_box(t) : united(boxes.back(), item.scene.triangle_box(t)));
    }
    boxes.push_back(item.scene.bounds);
    std::vector<float> values(boxes.size());
    measure->evaluate(boxes, values);
    EXPECT_EQ(values[0], 0) << "the empty box";
    for (std::size_t i = 1; i < boxes.size(); ++i) {
      ASSERT_TRUE(std::isfinite(values[i]) && values[i] >= 0);
      if (boxes[i].contains(boxes[i - 1])) {
        ASSERT_GE(values[i], values[i - 1]);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conformance, Workloads, testing::ValuesIn(variants(Role::workload)), variant_name);
INSTANTIATE_TEST_SUITE_P(Conformance, Metrics, testing::ValuesIn(variants(Role::metric)), variant_name);
INSTANTIATE_TEST_SUITE_P(Conformance, Heuristics, testing::ValuesIn(variants(Role::heuristic)), variant_name);

}  // namespace
}  // namespace raystudy::test
