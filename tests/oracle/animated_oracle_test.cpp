// Every animated scene that is at hand: after a refit hits are right in every frame that is looked at, between key frames too.
// All 50 frames of each are checked by experiments/animated-scenes.yaml.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "harness/accel/refit.h"
#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "harness/run/oracle.h"
#include "harness/scene/animation.h"
#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"

namespace raystudy {
namespace {

std::vector<RayBatch> rays_in(const Scene& frame) {
  const Registry& registry = Registry::instance();
  std::vector<RayBatch> batches;
  batches.push_back(
      registry
          .create<Workload>(registry.ref(Role::workload, "primary", {{"width", std::int64_t{96}}, {"height", std::int64_t{72}}}))
          ->generate(frame, {}));
  batches.push_back(
      registry.create<Workload>(registry.ref(Role::workload, "random", {{"count", std::int64_t{4000}}}))->generate(frame, {}));
  return batches;
}

void expect_right(const Accel& accel, const std::string& tracer, const Scene& frame, const std::vector<RayBatch>& batches) {
  const Registry& registry = Registry::instance();
  const Oracle oracle(frame);
  ReferenceTracer reference(frame, 2);
  for (const RayBatch& batch : batches) {
    std::vector<Hit> expected(batch.rays.size());
    reference.trace(batch.rays, expected, batch.query);
    std::vector<Hit> hits(batch.rays.size());
    registry.create<Tracer>(registry.ref(Role::tracer, tracer))
        ->prepare(accel, frame, 2, batch.coherent)
        ->trace(batch.rays, hits, batch.query);
    const OracleReport report = oracle.check(batch.rays, hits, expected, batch.query, true, 16);
    EXPECT_TRUE(report.ok()) << tracer << ": " << report.text(batch.rays, batch.query);
  }
}

void check_animation(const Scene& scene) {
  const Registry& registry = Registry::instance();
  const auto built = registry.create<Builder>(registry.ref(Role::builder, "sweep-sah"))->build(scene, {});
  auto& bvh = dynamic_cast<Bvh2&>(*built);
  const auto encoder = registry.create<Encoder>(registry.ref(Role::encoder, "bvh8"));
  Refitter refitter(bvh, scene.triangles, RefitMethod::subtrees, 2);
  for (const double time : uniform_times(6)) {
    SCOPED_TRACE(scene.name + " at time " + std::to_string(time));
    const Scene frame = scene_at(scene, time);
    refitter.refit(bvh, frame.vertices);
    EXPECT_TRUE(find_problems(bvh, frame).empty());
    const std::vector<RayBatch> batches = rays_in(frame);
    expect_right(bvh, "scalar", frame, batches);
    expect_right(*encoder->encode(bvh, frame, {}), "wide", frame, batches);
  }
}

class AnimatedOracle : public testing::TestWithParam<std::string> {};

TEST_P(AnimatedOracle, EveryFrameIsTracedRightAfterRefit) {
  try {
    check_animation(find_procedural(GetParam()) != nullptr ? make_procedural(GetParam(), 8000, 1) : open_scene(GetParam()));
  } catch (const SceneNotInstalled& missing) {
    GTEST_SKIP() << missing.what();
  }
}

std::vector<std::string> animated_names() {
  std::vector<std::string> names;
  for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) {
    if (!entry.frames.empty()) names.push_back(entry.name);
  }
  for (const ProceduralInfo& info : procedural_scenes()) {
    if (info.frames > 0) names.push_back(info.name);
  }
  return names;
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnimatedOracle, testing::ValuesIn(animated_names()), test_name);

}  // namespace
}  // namespace raystudy
