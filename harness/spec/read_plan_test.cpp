#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/method/registry.h"
#include "harness/spec/cells.h"
#include "harness/spec/plan.h"
#include "harness/spec/reading.h"

namespace raystudy {
namespace {

using testing::ElementsAre;

Plan read(const std::string& text, Scale scale = Scale::quick) { return parse_plan(text, "studies/study.yaml", scale); }

/// A study of one scene and these methods.
Plan read_methods(const std::string& methods, const std::string& rest = {}) {
  return read("scenes: [sibenik-ogre]\nmethods:\n" + methods + rest);
}

const PipelineSpec& pipeline(const Plan& plan, std::string_view label) {
  return plan.pipelines.at(index_of(plan.pipelines, label).value());
}

TEST(ReadPlan, AnimationsAndTheUpdatersOfTheirMethods) {
  const Plan plan = read_methods(
      "  a: {builder: test-builder, update: {test-updater: {every: [2, 5]}}, encode: test-encoder}\n"
      "  b: {from: a, optimize: test-optimizer, update: test-updater}\n",
      "animation: {frames: {quick: 5, paper: 50}}\n");
  EXPECT_EQ(plan.animation.value().frames, 5U);
  EXPECT_EQ(canonical(*pipeline(plan, "a[every=5]").updater), "test-updater{every=5}");
  EXPECT_EQ(pipeline(plan, "a[every=5]").encoder->name, "test-encoder");
  EXPECT_EQ(canonical(*pipeline(plan, "b").updater), "test-updater{every=1}");
  EXPECT_FALSE(read_methods("  a: test-builder\n").animation);
  EXPECT_EQ(read_methods("  a: {builder: test-builder, update: test-updater}\n", "animation: {}\n").animation->frames, 50U);
}

TEST(ReadPlan, SettingsAndTheirDefaults) {
  const Plan plan = read("scenes: [sibenik-ogre]\nmethods: {a: test-builder}\n");
  EXPECT_EQ(plan.name, "study");
  EXPECT_EQ(plan.title, "study");
  EXPECT_EQ(plan.seed, 1U);
  EXPECT_EQ(plan.threads, 1);
  EXPECT_EQ(plan.repetitions, 3);
  EXPECT_EQ(plan.timeout_seconds, 0);
  EXPECT_EQ(plan.cost.traversal, 3);
  EXPECT_EQ(plan.cost.intersection, 2);
  EXPECT_EQ(canonical(plan.cost.heuristic), "surface-area{}");
  EXPECT_FALSE(plan.metrics.empty());

  const Plan other = read(R"(
title: "Costs: a study"
paper: insertion-bittner
cost: {c_T: 1.2, c_I: 1, heuristic: surface-area}
seed: 7
threads: 2
repetitions: 1e1
warm_up: 100 ms
timeout: 2min
memory_limit: 1.5 GiB
scenes: [sibenik-ogre]
methods: {a: test-builder}
metrics: []
)");
  EXPECT_EQ(other.title, "Costs: a study");
  EXPECT_EQ(other.paper, "insertion-bittner");
  EXPECT_EQ(other.seed, 7U);
  EXPECT_EQ(other.threads, 2);
  EXPECT_EQ(other.repetitions, 10);
  EXPECT_DOUBLE_EQ(other.warm_up_seconds, 0.1);
  EXPECT_EQ(other.timeout_seconds, 120);
  EXPECT_EQ(other.memory_limit_bytes, 1.5 * 1024 * 1024 * 1024);
  EXPECT_EQ(other.cost.traversal, 1.2);
  EXPECT_TRUE(other.metrics.empty());
}

TEST(ReadPlan, AValueByScaleIsTheLargestNotAboveIt) {
  const std::string text =
      "scenes: {quick: [sibenik-ogre], paper: [sibenik-ogre, conference]}\n"
      "repetitions: {quick: 2, full: 5}\nmethods: {a: {builder: {test-builder: {bins: {quick: 4, paper: 32}}}}}\n";
  EXPECT_EQ(read(text, Scale::quick).repetitions, 2);
  EXPECT_EQ(read(text, Scale::full).repetitions, 5);
  EXPECT_EQ(read(text, Scale::paper).repetitions, 5);
  EXPECT_THAT(labels_of(read(text, Scale::full).scenes), ElementsAre("sibenik-ogre"));
  EXPECT_THAT(labels_of(read(text, Scale::paper).scenes), ElementsAre("sibenik-ogre", "conference"));
  EXPECT_EQ(read(text, Scale::full).pipelines[0].builder.params->integer("bins"), 4);
  EXPECT_EQ(read(text, Scale::paper).pipelines[0].builder.params->integer("bins"), 32);
}

TEST(ReadPlan, ScenesFromCatalogGeneratorsAndFiles) {
  const Plan plan = read(
      "scenes:\n  - sibenik-ogre\n  - terrain: {triangles: [1000, 1e4], seed: 3}\n  - soup: {triangles: 2000, label: small}\n"
      "  - ./models/cow.obj\nmethods: {a: test-builder}\n");
  EXPECT_THAT(labels_of(plan.scenes),
              ElementsAre("sibenik-ogre", "terrain[triangles=1000]", "terrain[triangles=10000]", "small", "cow"));
  EXPECT_EQ(plan.scenes[2].triangles, 10000);
  EXPECT_EQ(plan.scenes[2].seed, 3U);
  EXPECT_EQ(plan.scenes[2].identity, "terrain triangles=10000 seed=3");
  EXPECT_EQ(plan.scenes[3].name, "soup");
  EXPECT_EQ(plan.scenes[4].name, "./models/cow.obj");
  EXPECT_EQ(plan.scenes[4].identity, "./models/cow.obj xxh3=none");
  EXPECT_THAT(plan.scenes[0].identity, testing::StartsWith("sibenik-ogre triangles=80479 sha256=286e3894"));
}

TEST(ReadPlan, FromAppendsOptimizersAndOverridesTheRest) {
  const Plan plan = read_methods(
      "  child: {from: base, optimize: [test-optimizer: {percent: 2}]}\n"
      "  base: {builder: {test-builder: {bins: 8}}, optimize: test-optimizer}\n"
      "  grandchild: {from: child, builder: test-builder, encode: test-encoder}\n");
  EXPECT_THAT(labels_of(plan.pipelines), ElementsAre("child", "base", "grandchild"));
  const PipelineSpec& child = pipeline(plan, "child");
  EXPECT_EQ(child.builder.params->integer("bins"), 8);
  ASSERT_EQ(child.optimizers.size(), 2U);
  EXPECT_EQ(child.optimizers[0].params->real("percent"), 1);
  EXPECT_EQ(child.optimizers[1].params->real("percent"), 2);
  const PipelineSpec& grandchild = pipeline(plan, "grandchild");
  EXPECT_EQ(grandchild.builder.params->integer("bins"), 16);
  EXPECT_EQ(grandchild.optimizers.size(), 2U);
  EXPECT_EQ(grandchild.encoder->name, "test-encoder");
}

TEST(ReadPlan, AListOfValuesIsASweep) {
  const Plan plan = read_methods(
      "  a: {builder: {test-builder: {bins: [8, 32], centres: box}}, optimize: [test-optimizer: {percent: [0.5, 2], bins: 2}]}\n"
      "  b: {builder: [test-builder, test-foreign]}\n");
  EXPECT_THAT(labels_of(plan.pipelines),
              ElementsAre("a[bins=8,percent=0.5]", "a[bins=8,percent=2]", "a[bins=32,percent=0.5]", "a[bins=32,percent=2]",
                          "b[builder=test-builder]", "b[builder=test-foreign]"));
  const PipelineSpec& second = plan.pipelines[1];
  EXPECT_EQ(second.base, "a");
  EXPECT_EQ(std::get<std::int64_t>(second.sweep.at("bins")), 8);
  EXPECT_EQ(std::get<double>(second.sweep.at("percent")), 2);
  EXPECT_EQ(second.builder.params->integer("bins"), 8);
  EXPECT_EQ(second.optimizers[0].params->real("percent"), 2);
  EXPECT_EQ(second.optimizers[0].params->integer("bins"), 2);
}

TEST(ReadPlan, ASweptParameterThatTwoStagesShareIsNamedWithItsMethod) {
  const Plan plan = read_methods(
      "  a: {builder: {test-builder: {bins: [8, 32]}}, optimize: [test-optimizer: {bins: [1, 2]}, test-optimizer: {bins: [3, "
      "4]}]}\n");
  EXPECT_EQ(plan.pipelines.size(), 8U);
  EXPECT_EQ(plan.pipelines[0].label, "a[test-builder.bins=8,test-optimizer.bins=1,test-optimizer.bins#2=3]");
}

TEST(ReadPlan, TracersAreThoseThatTakeWhatComesOut) {
  const Plan plan =
      read_methods("  tree: test-builder\n  wide: {from: tree, encode: test-encoder}\n  built: {from: tree, tracers: []}\n",
                   "tracers: {a: test-tracer, b: test-wide-tracer}\nworkloads: {few: {test-rays: {count: [10, 20]}}}\n");
  EXPECT_THAT(pipeline(plan, "tree").tracers, ElementsAre("a"));
  EXPECT_THAT(pipeline(plan, "wide").tracers, ElementsAre("b"));
  EXPECT_THAT(pipeline(plan, "built").tracers, ElementsAre());
  EXPECT_THAT(labels_of(plan.workloads), ElementsAre("few[count=10]", "few[count=20]"));
  std::vector<std::string> paths;
  for (const Cell& cell : plan.cells) paths.push_back(cell_path(plan, cell));
  EXPECT_THAT(paths, ElementsAre("sibenik-ogre/tree", "sibenik-ogre/tree/a/few[count=10]", "sibenik-ogre/tree/a/few[count=20]",
                                 "sibenik-ogre/wide", "sibenik-ogre/wide/b/few[count=10]", "sibenik-ogre/wide/b/few[count=20]",
                                 "sibenik-ogre/built"));
}

TEST(ReadPlan, AnchorsMayBeUsed) {
  const Plan plan = read_methods("  a: {builder: &b {test-builder: {bins: 4}}}\n  b: {builder: *b}\n");
  EXPECT_EQ(pipeline(plan, "b").builder.params->integer("bins"), 4);
}

}  // namespace
}  // namespace raystudy
