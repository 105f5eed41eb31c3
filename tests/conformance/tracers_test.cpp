// Every tracer over every structure it can trace, on every scene: its hits are right by the oracle, for both queries, for any
// number of threads, and it counts what it traces.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "harness/base/unsupported.h"
#include "harness/run/oracle.h"
#include "tests/conformance/scenes.h"
#include "tests/conformance/variants.h"
#include "tests/support/brute_force.h"
#include "tests/support/rays.h"

namespace raystudy::test {
namespace {

/// What every builder of `kind` makes of a scene, and every encoder of the kind of the first tree of each builder.
std::vector<std::pair<std::string, std::unique_ptr<Accel>>> accels_of(const std::string& kind, const Scene& scene) {
  const Registry& registry = Registry::instance();
  const BuildContext context;
  std::vector<std::pair<std::string, std::unique_ptr<Accel>>> all;
  for (const Variant& builder : variants(Role::builder)) {
    if (builder.accel == kind && !builder.on_device)
      all.emplace_back(builder.label, registry.create<Builder>(builder.ref)->build(scene, context));
  }
  for (const Variant& encoder : variants(Role::encoder)) {
    if (encoder.accel != kind) continue;
    for (const Variant& builder : variants(Role::builder, true)) {
      if (builder.accel != Bvh2::kind_name) continue;
      const auto tree = registry.create<Builder>(builder.ref)->build(scene, context);
      all.emplace_back(encoder.label + " of " + builder.label,
                       registry.create<Encoder>(encoder.ref)->encode(dynamic_cast<const Bvh2&>(*tree), scene, context));
    }
  }
  return all;
}

class Tracers : public testing::TestWithParam<Variant> {};

void check_counts(TraceSession& session, std::span<const Ray> rays, Query query) {
  std::vector<std::uint32_t> steps(rays.size());
  const TraceCounts counts = session.count(rays, query, steps);
  EXPECT_EQ(std::accumulate(steps.begin(), steps.end(), std::uint64_t{0}), counts.traversal_steps());
  const TraceCounts again = session.count(rays, query, {});
  EXPECT_EQ(again.traversal_steps(), counts.traversal_steps());
  EXPECT_EQ(again.triangle_tests, counts.triangle_tests);
}

/// Closest hits bit for bit; of any hits whether there is one, for which of them is found may depend on how rays are grouped.
void expect_same_hits(std::span<const Hit> a, std::span<const Hit> b, Query query) {
  if (query == Query::closest_hit) {
    expect_same(a, b);
  } else {
    EXPECT_TRUE(
        std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Hit& x, const Hit& y) { return x.is_hit() == y.is_hit(); }));
  }
}

TEST_P(Tracers, AgreeWithTheOracle) {
  if (const std::string why = why_not_here(GetParam()); !why.empty()) GTEST_SKIP() << why;
  std::unique_ptr<Tracer> tracer;
  try {
    tracer = Registry::instance().create<Tracer>(GetParam().ref);
  } catch (const Unsupported& error) {
    GTEST_SKIP() << error.what();
  }
  for (const ConformanceScene& item : conformance_scenes()) {
    if (!item.within_embree_range && GetParam().accel == "embree") continue;
    const std::vector<Ray> rays = conformance_rays(item.scene);
    const std::vector<Hit> reference = closest_hits(item.scene, rays);
    Oracle oracle(item.scene);
    for (const auto& [label, accel] : accels_of(GetParam().accel, item.scene)) {
      for (const Query query : {Query::closest_hit, Query::any_hit}) {
        std::vector<std::vector<Hit>> hits;
        for (const int threads : {1, 2}) {
          SCOPED_TRACE(item.name + ", " + label + ", " + std::string(query_name(query)) + ", " + std::to_string(threads) +
                       " threads");
          const auto session = tracer->prepare(*accel, item.scene, threads, threads == 2);
          hits.emplace_back(rays.size());
          session->trace(rays, hits.back(), query);
          const OracleReport report = oracle.check(rays, hits.back(), reference, query, session->watertight(), 8);
          EXPECT_TRUE(report.ok()) << report.text(rays, query);
          if (session->counts()) check_counts(*session, rays, query);
          // Embree alone is not watertight, and chooses by its coherent flag how it intersects.
          if (threads == 2 && session->watertight()) expect_same_hits(hits[0], hits[1], query);
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Conformance, Tracers, testing::ValuesIn(variants(Role::tracer)), variant_name);

}  // namespace
}  // namespace raystudy::test
