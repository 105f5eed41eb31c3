// Every tracer over every scene of the catalog that is at hand and over every procedural scene: whole buffers agree with robust
// Embree, samples and disputed rays with exact arithmetic.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "harness/method/registry.h"
#include "harness/run/oracle.h"
#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"
#include "harness/vulkan/device.h"
#include "tests/support/test_name.h"

namespace raystudy {
namespace {

using Changes = std::map<std::string, ParamValue, std::less<>>;

struct TracedAccel {
  std::string label;
  std::unique_ptr<Accel> accel;
};

/// A method's parameters that change how it computes: its defaults, and each other choice of each choice parameter.
std::vector<Changes> variants(const MethodInfo& info) {
  std::vector<Changes> all{{}};
  for (const ParamSpec& param : info.params) {
    if (param.type != ParamType::choice) continue;
    for (std::size_t i = 1; i < param.choices.size(); ++i) all.push_back({{param.name, param.choices[i]}});
  }
  return all;
}

/// One structure of each kind that a builder makes, Bvh2 by sweep SAH and everything encoders make of that; Embree with and
/// without its robust flag.
std::vector<TracedAccel> accels(const Scene& scene) {
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = 2;
  std::map<std::string, MethodRef, std::less<>> builder_of_kind;
  for (const Registry::Entry* entry : registry.entries()) {
    if (entry->role == Role::builder && !entry->info.needs_file())
      builder_of_kind.try_emplace(entry->info.accel, registry.ref(Role::builder, entry->info.name));
  }
  const MethodRef sweep = registry.ref(Role::builder, "sweep-sah");
  builder_of_kind["bvh2"] = sweep;
  builder_of_kind["robust"] = registry.ref(Role::builder, "embree", {{"robust", true}});
  std::vector<TracedAccel> all;
  for (const auto& [kind, ref] : builder_of_kind) {
    all.push_back({canonical(ref), registry.create<Builder>(ref)->build(scene, context)});
  }
  const auto binary = registry.create<Builder>(sweep)->build(scene, context);
  for (const Registry::Entry* entry : registry.entries()) {
    if (entry->role != Role::encoder) continue;
    for (const Changes& changes : variants(entry->info)) {
      const MethodRef ref = registry.ref(Role::encoder, entry->info.name, changes);
      all.push_back({canonical(sweep) + " + " + canonical(ref),
                     registry.create<Encoder>(ref)->encode(dynamic_cast<const Bvh2&>(*binary), scene, context)});
    }
  }
  return all;
}

struct Traced {
  std::string label;
  RayBatch batch;
  std::vector<Hit> reference;
};

/// About 20 000 rays of each registered workload.
std::vector<Traced> workloads(const Scene& scene, ReferenceTracer& reference) {
  const std::map<std::string, Changes, std::less<>> sizes{
      {"primary", {{"width", std::int64_t{160}}, {"height", std::int64_t{120}}}},
      {"random", {{"count", std::int64_t{20000}}}},
      {"ambient-occlusion", {{"width", std::int64_t{64}}, {"height", std::int64_t{48}}, {"rays", std::int64_t{6}}}},
      {"shadow", {{"width", std::int64_t{112}}, {"height", std::int64_t{84}}, {"radius", 0.01}}},
      {"reflection", {{"width", std::int64_t{160}}, {"height", std::int64_t{120}}}}};
  const Registry& registry = Registry::instance();
  const WorkloadContext context{1, [&](auto rays, auto hits) { reference.trace(rays, hits, Query::closest_hit); }};
  std::vector<Traced> all;
  for (const std::string& name : registry.names(Role::workload)) {
    const auto size = sizes.find(name);
    const auto workload =
        registry.create<Workload>(registry.ref(Role::workload, name, size == sizes.end() ? Changes{} : size->second));
    Traced traced{name, workload->generate(scene, context), {}};
    traced.reference.resize(traced.batch.rays.size());
    reference.trace(traced.batch.rays, traced.reference, traced.batch.query);
    all.push_back(std::move(traced));
  }
  return all;
}

void check_scene(const Scene& scene) {
  const Registry& registry = Registry::instance();
  Oracle oracle(scene);
  ReferenceTracer reference(scene, 2);
  const std::vector<Traced> buffers = workloads(scene, reference);
  const bool has_device = !vulkan::list_devices().empty();
  for (const TracedAccel& traced : accels(scene)) {
    for (const Registry::Entry* entry : registry.entries()) {
      if (entry->role != Role::tracer || entry->info.accel != traced.accel->kind()) continue;
      if (entry->info.on_device && !has_device) continue;
      for (const Changes& changes : variants(entry->info)) {
        const MethodRef ref = registry.ref(Role::tracer, entry->info.name, changes);
        for (const Traced& buffer : buffers) {
          const auto session = registry.create<Tracer>(ref)->prepare(*traced.accel, scene, 2, buffer.batch.coherent);
          std::vector<Hit> hits(buffer.batch.rays.size());
          session->trace(buffer.batch.rays, hits, buffer.batch.query);
          // Exact samples for the defaults; the other variants differ in how they reach the same triangles.
          const OracleReport report = oracle.check(buffer.batch.rays, hits, buffer.reference, buffer.batch.query,
                                                   session->watertight(), changes.empty() ? 64 : 0);
          EXPECT_TRUE(report.ok()) << scene.name << ", " << traced.label << ", " << canonical(ref) << ", " << buffer.label << ": "
                                   << report.text(buffer.batch.rays, buffer.batch.query);
          // The exact kernel is for the rare boundary case; where much is disputed something is wrong with the comparison.
          EXPECT_LE(report.leaks, 5U);
          EXPECT_LE(report.disputed, report.rays / 100 + 5) << scene.name << ", " << canonical(ref) << ", " << buffer.label;
        }
      }
    }
  }
}

class CatalogOracle : public testing::TestWithParam<std::string> {};

TEST_P(CatalogOracle, EveryTracerAgrees) {
  try {
    check_scene(open_scene(GetParam()));
  } catch (const SceneNotInstalled& missing) {
    GTEST_SKIP() << missing.what();
  }
}

class ProceduralOracle : public testing::TestWithParam<std::string> {};

TEST_P(ProceduralOracle, EveryTracerAgrees) { check_scene(make_procedural(GetParam(), 20000, 1)); }

std::vector<std::string> catalog_names() {
  std::vector<std::string> names;
  for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) names.push_back(entry.name);
  return names;
}

std::vector<std::string> procedural_names() {
  std::vector<std::string> names;
  for (const ProceduralInfo& info : procedural_scenes()) names.push_back(info.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, CatalogOracle, testing::ValuesIn(catalog_names()), test::test_name);
INSTANTIATE_TEST_SUITE_P(Scenes, ProceduralOracle, testing::ValuesIn(procedural_names()), test::test_name);

}  // namespace
}  // namespace raystudy
