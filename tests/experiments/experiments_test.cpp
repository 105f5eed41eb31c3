// The experiments that come with Raystudy are its examples: each reads without a mistake at every scale.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
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
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
});

/// The names of each role that an experiment on built-in scenes uses.
std::map<Role, std::set<std::string>> used_in(const std::string& file) {
  const Plan plan = read_plan(RAYSTUDY_SOURCE_DIR "/experiments/" + file, Scale::quick);
  for (const SceneSpec& scene : plan.scenes) EXPECT_GT(scene.triangles, 0) << scene.label;
  std::map<Role, std::set<std::string>> used;
  for (const PipelineSpec& pipeline : plan.pipelines) {
    used[Role::builder].insert(pipeline.builder.name);
    for (const MethodRef& optimizer : pipeline.optimizers) used[Role::optimizer].insert(optimizer.name);
    if (pipeline.updater) used[Role::updater].insert(pipeline.updater->name);
  }
  for (const WorkloadSpec& workload : plan.workloads) used[Role::workload].insert(workload.label);
  return used;
}

TEST(Quickstart, ShowsBuiltInScenesAndEveryBuilderOptimizerAndUpdater) {
  std::map<Role, std::set<std::string>> used = used_in("quickstart.yaml");
  EXPECT_GE(used[Role::workload].size(), 2U);
  for (auto& [role, names] : used_in("quickstart-animation.yaml")) used[role].merge(names);
  for (const Role role : {Role::builder, Role::optimizer, Role::updater}) {
    for (const std::string& name : Registry::instance().names(role)) {
      EXPECT_TRUE(used[role].contains(name) || Registry::instance().get(role, name).info.needs_file()) << name;
    }
  }
}

}  // namespace
}  // namespace raystudy
