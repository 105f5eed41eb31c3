#include "harness/run/animation_run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "harness/method/registry.h"
#include "harness/run/run.h"
#include "harness/run/test_methods.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

class AnimationRunTest : public testing::Test {
 public:
  AnimationRunTest() : folder(fs::path(testing::TempDir()) / fmt::format("animation-run-{}", getpid())) {
    fs::create_directories(folder);
    options.results = folder;
    options.open = open_test_scene;
    options.sample_seconds = 1e-9;
    options.log = std::fopen((folder / "log").c_str(), "w");
  }
  ~AnimationRunTest() override {
    std::fclose(options.log);
    fs::remove_all(folder);
  }

 protected:
  [[nodiscard]] CellResult result_of(const Plan& plan, std::size_t cell) const {
    return read_result(result_file(results_folder(plan, folder), cell_id(plan, plan.cells[cell])));
  }

  fs::path folder;
  RunOptions options;
};

TEST_F(AnimationRunTest, MeasuresEveryFrame) {
  Plan plan = test_plan({"good", "good optimized"});
  add_animation(plan, 5, "good");
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 2U);
  EXPECT_EQ(summary.failed, 0U);
  const CellResult result = result_of(plan, 0);
  const Series& costs = result.series.at("frame_cost");
  EXPECT_EQ(costs.x, (std::vector<double>{0, 1, 2, 3, 4}));
  ASSERT_THAT(costs.y, SizeIs(5));
  EXPECT_NE(costs.y[1], costs.y[4]) << "each frame's own tree";
  EXPECT_EQ(result.values.at("maximum_cost").median(), *std::max_element(costs.y.begin(), costs.y.end()));
  EXPECT_DOUBLE_EQ(result.values.at("average_cost").median(),
                   (costs.y[0] + costs.y[1] + costs.y[2] + costs.y[3] + costs.y[4]) / 5);
  EXPECT_THAT(result.values.at("update_time").samples, SizeIs(3)) << "one a repetition";
  EXPECT_GE(result.values.at("maximum_update_time").median(), result.values.at("update_time").median());
  EXPECT_THAT(result.series.at("frame_update_time").y, SizeIs(5));
  EXPECT_EQ(result.series.at("frame_rebuilds").y, (std::vector<double>{0, 1, 1, 2, 2}));
  EXPECT_EQ(result.values.at("rebuilds").median(), 2);
  EXPECT_EQ(result.values.at("tree_memory").median(), 100);
  EXPECT_THAT(result.values.at("build_time").samples, SizeIs(3));
  EXPECT_GE(result.values.at("total_time").median(), result.values.at("build_time").median());
  const CellResult optimized = result_of(plan, 1);
  EXPECT_THAT(optimized.values.at("optimize_time").samples, SizeIs(3));
  EXPECT_EQ(optimized.series.at("cost_over_time").y, (std::vector<double>{100, 90, 100, 90})) << "of the first tree only";
}

/// The test tracer knows the strip at rest only: one frame.
TEST_F(AnimationRunTest, TracesEveryFrameAndAddsUpTheAnimation) {
  Plan plan = test_plan({"good"});
  add_animation(plan, 1, "good");
  add_traces(plan, {"good", "count"});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 3U);
  const CellResult result = result_of(plan, 1);
  EXPECT_EQ(result.values.at("ray_count").median(), 2 * test_triangles);
  EXPECT_EQ(result.values.at("hit_share").median(), 0.5);
  EXPECT_THAT(result.values.at("frame_time").samples, SizeIs(3));
  EXPECT_GT(result.values.at("frame_time").median(), result.values.at("trace_time").median()) << "with the update";
  EXPECT_THAT(result.series.at("frame_total_time").y, SizeIs(1));
  EXPECT_EQ(result_of(plan, 2).values.at("triangle_tests_per_ray").median(), 5);
}

TEST_F(AnimationRunTest, TimesOfADeviceTakeThePlaceOfTheWallClocks) {
  Plan plan = test_plan({"good", "device"});
  add_animation(plan, 1, "good");
  add_traces(plan, {"device"});
  plan.pipelines[0].updater = Registry::instance().ref(Role::updater, "test-updater", {{"behaviour", "device"}});
  EXPECT_EQ(run_plan(plan, options).done, 3U);
  EXPECT_EQ(result_of(plan, 0).values.at("update_time").samples, std::vector<double>(3, 7)) << "by the updater";
  const std::vector<double> rebuilt = result_of(plan, 1).values.at("update_time").samples;
  EXPECT_THAT(rebuilt, testing::Each(testing::DoubleNear(3, 0.5))) << "by the builder that the updater calls";
  EXPECT_EQ(result_of(plan, 2).values.at("frame_time").samples, std::vector<double>(3, 12));
}

TEST_F(AnimationRunTest, ADeviceMayBuildOnlyWhileTheAnimationPlays) {
  Plan plan = test_plan({"device"});
  add_animation(plan, 2, "build later");
  EXPECT_EQ(run_plan(plan, options).done, 1U);
  EXPECT_EQ(result_of(plan, 0).values.at("build_time").samples, std::vector<double>(3, 0));
  EXPECT_FALSE(result_of(plan, 0).values.contains("build_time:sort"));
}

TEST_F(AnimationRunTest, AWrongHitInAnyFrameFailsItsCell) {
  Plan plan = test_plan({"good"});
  add_animation(plan, 2, "good");
  add_traces(plan, {"good"});  // hits the strip where it was in the first frame
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(summary.failed, 1U);
  EXPECT_THAT(result_of(plan, 1).reason, HasSubstr("wrong"));
}

TEST_F(AnimationRunTest, ATreeThatDoesNotFollowFailsItsMethodOnly) {
  Plan plan = test_plan({"good", "good optimized"});
  add_animation(plan, 3, "good");
  plan.pipelines[0].updater = Registry::instance().ref(Role::updater, "test-updater", {{"behaviour", "keep"}});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_THAT(result_of(plan, 0).reason, HasSubstr("wrong tree"));
  EXPECT_EQ(result_of(plan, 1).status, CellStatus::done);
}

TEST_F(AnimationRunTest, FailuresOfUpdatersAreRows) {
  for (const auto& [behaviour, reason] : {std::pair{"throw", "error while building: no session"},
                                          {"throw in frame 1", "error while updating: lost the frame"},
                                          {"crash in frame 1", "crashed: SIGSEGV while updating"}}) {
    Plan plan = test_plan({"good"});
    add_animation(plan, 3, behaviour);
    const RunSummary summary = run_plan(plan, options);
    EXPECT_EQ(summary.failed, 1U) << behaviour;
    EXPECT_THAT(result_of(plan, 0).reason, HasSubstr(reason));
  }
}

}  // namespace
}  // namespace raystudy
