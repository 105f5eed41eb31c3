// Every updater over every animated scene, of the catalog where it is at hand and built in: after each update the tree is valid
// for its frame, and whole buffers of hits agree with robust Embree, samples and disputed rays with exact arithmetic.

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "harness/accel/validate.h"
#include "harness/method/registry.h"
#include "harness/run/oracle.h"
#include "harness/scene/animation.h"
#include "harness/scene/catalog.h"
#include "harness/scene/open.h"
#include "harness/scene/procedural.h"
#include "harness/vulkan/device.h"
#include "tests/support/test_name.h"

namespace raystudy {
namespace {

constexpr int threads = 2;

bool works_here(const Registry::Entry& entry) {
  static const bool has_device = !vulkan::list_devices().empty();
  return has_device || !entry.info.on_device;
}

/// One frame, its rays and the reference's hits.
struct Frame {
  Scene scene;
  Oracle oracle;
  std::vector<RayBatch> batches{};
  std::vector<std::vector<Hit>> reference{};

  explicit Frame(Scene own) : scene(std::move(own)), oracle(scene) {
    const Registry& registry = Registry::instance();
    ReferenceTracer tracer(scene, threads);
    for (const MethodRef& ref :
         {registry.ref(Role::workload, "primary", {{"width", std::int64_t{64}}, {"height", std::int64_t{48}}}),
          registry.ref(Role::workload, "random", {{"count", std::int64_t{3000}}})}) {
      batches.push_back(registry.create<Workload>(ref)->generate(scene, {}));
      reference.emplace_back(batches.back().rays.size());
      tracer.trace(batches.back().rays, reference.back(), batches.back().query);
    }
  }

  /// By every tracer of that kind of structure.
  void check(const Accel& accel, const std::string& label) {
    for (const Registry::Entry* entry : Registry::instance().entries()) {
      if (entry->role != Role::tracer || entry->info.accel != accel.kind() || !works_here(*entry)) continue;
      const auto tracer = Registry::instance().create<Tracer>(Registry::instance().ref(Role::tracer, entry->info.name));
      for (std::size_t b = 0; b < batches.size(); ++b) {
        const RayBatch& batch = batches[b];
        const auto session = tracer->prepare(accel, scene, threads, batch.coherent);
        std::vector<Hit> hits(batch.rays.size());
        session->trace(batch.rays, hits, batch.query);
        const OracleReport report = oracle.check(batch.rays, hits, reference[b], batch.query, session->watertight(), 16);
        EXPECT_TRUE(report.ok()) << label << ", " << entry->info.name << ": " << report.text(batch.rays, batch.query);
      }
    }
  }
};

void check_animation(const Scene& scene) {
  ASSERT_GT(scene.frames.size(), 1U);
  const Registry& registry = Registry::instance();
  BuildContext context;
  context.threads = threads;
  const std::vector<double> times = uniform_times(4);
  const auto builder = registry.create<Builder>(registry.ref(Role::builder, "binned-sah"));
  const auto encoder = registry.create<Encoder>(registry.ref(Role::encoder, "bvh8"));
  const TreeBuild build = [&](const Scene& part) { return builder->build(part, context); };
  std::map<std::string, std::unique_ptr<UpdateSession>> sessions;
  for (const std::string& name : registry.names(Role::updater)) {
    if (!works_here(registry.get(Role::updater, name))) continue;
    sessions[name] = registry.create<Updater>(registry.ref(Role::updater, name))->prepare(scene, times, build, context);
  }
  for (std::size_t f = 0; f < times.size(); ++f) {
    Frame frame(scene_at(scene, times[f]));
    for (const auto& [name, session] : sessions) {
      const std::string label = scene.name + ", frame " + std::to_string(f) + ", " + name;
      const auto& tree = dynamic_cast<const Bvh2&>(*session->update(frame.scene, f).accel);
      EXPECT_THAT(find_problems(tree, frame.scene), testing::IsEmpty()) << label;
      frame.check(tree, label);
      frame.check(*encoder->encode(tree, frame.scene, context), label + ", bvh8");
    }
  }
}

class AnimationOracle : public testing::TestWithParam<std::string> {};

TEST_P(AnimationOracle, EveryUpdaterGivesTheRightHits) {
  try {
    const ProceduralInfo* built_in = find_procedural(GetParam());
    check_animation(built_in != nullptr ? make_procedural(GetParam(), 5000, 1) : open_scene(GetParam()));
  } catch (const SceneNotInstalled& missing) {
    GTEST_SKIP() << missing.what();
  }
}

std::vector<std::string> animated_scenes() {
  std::vector<std::string> names;
  for (const CatalogEntry& entry : read_catalog(catalog_path()).entries) {
    if (!entry.frames.empty()) names.push_back(entry.name);
  }
  for (const ProceduralInfo& info : procedural_scenes()) {
    if (info.frames > 0) names.push_back(info.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, AnimationOracle, testing::ValuesIn(animated_scenes()), test::test_name);

}  // namespace
}  // namespace raystudy
