// The experiments that come with Raystudy are its examples: each reads without a mistake at every scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "harness/method/registry.h"
#include "harness/report/table.h"
#include "harness/spec/cells.h"
#include "harness/spec/plan.h"

namespace raystudy {
namespace {

std::vector<std::string> experiments() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(RAYSTUDY_SOURCE_DIR "/experiments")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

class Experiments : public testing::TestWithParam<std::string> {};

TEST_P(Experiments, ReadsWithoutAMistakeAtEveryScale) {
  EXPECT_NO_THROW(check_plan(GetParam()));
  const Plan plan = read_plan(GetParam(), Scale::quick);
  EXPECT_FALSE(plan.cells.empty());
  const std::optional<Published> published = published_of(plan);
  EXPECT_NO_THROW(check_tables(plan, published ? &*published : nullptr));
}

INSTANTIATE_TEST_SUITE_P(All, Experiments, testing::ValuesIn(experiments()), [](const auto& file) {
  std::string name = std::filesystem::path(file.param).stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Quickstart, ShowsBuiltInScenesAndEveryBuilderAndOptimizer) {
  const Plan plan = read_plan(RAYSTUDY_SOURCE_DIR "/experiments/quickstart.yaml", Scale::quick);
  for (const SceneSpec& scene : plan.scenes) EXPECT_GT(scene.triangles, 0) << scene.label;
  std::set<std::string> used;
  for (const PipelineSpec& pipeline : plan.pipelines) {
    used.insert(pipeline.builder.name);
    for (const MethodRef& optimizer : pipeline.optimizers) used.insert(optimizer.name);
  }
  for (const Role role : {Role::builder, Role::optimizer}) {
    for (const std::string& name : Registry::instance().names(role)) {
      EXPECT_TRUE(used.contains(name) || Registry::instance().get(role, name).info.needs_file()) << name;
    }
  }
  EXPECT_GE(plan.workloads.size(), 2U);
}

}  // namespace
}  // namespace raystudy
