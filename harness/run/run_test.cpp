#include "harness/run/run.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "harness/base/error.h"
#include "harness/run/memory.h"
#include "harness/run/result.h"
#include "harness/run/test_methods.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunTest : public testing::Test {
 public:
  RunTest() : folder(fs::path(testing::TempDir()) / fmt::format("run-{}", getpid())) {
    fs::create_directories(folder);
    options.results = folder;
    options.command = "raystudy run test.yaml";
    options.open = open_test_scene;
    options.sample_seconds = 1e-9;
    options.log = std::fopen((folder / "log").c_str(), "w");
  }
  ~RunTest() override {
    std::fclose(options.log);
    fs::remove_all(folder);
  }

 protected:
  [[nodiscard]] CellResult result_of(const Plan& plan, std::size_t cell) const {
    return read_result(result_file(results_folder(plan, folder), cell_id(plan, plan.cells[cell])));
  }
  [[nodiscard]] std::string log() const {
    std::fflush(options.log);
    std::stringstream text;
    text << std::ifstream(folder / "log").rdbuf();
    return text.str();
  }

  fs::path folder;
  RunOptions options;
};

TEST_F(RunTest, MeasuresEveryCellOfAPlan) {
  const Plan plan = test_plan({"good", "good optimized"});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 2U);
  EXPECT_EQ(summary.failed + summary.missing + summary.reused + summary.left, 0U);
  const CellResult plain = result_of(plan, 0);
  EXPECT_EQ(plain.status, CellStatus::done);
  EXPECT_EQ(plain.experiment, "test");
  EXPECT_EQ(plain.scene, "strip");
  EXPECT_EQ(plain.method, "good");
  EXPECT_EQ(plain.values.at("triangles").samples, std::vector<double>{test_triangles});
  EXPECT_EQ(plain.values.at("build_time").samples.size(), 3U);
  EXPECT_EQ(plain.values.at("total_time"), plain.values.at("build_time"));
  EXPECT_FALSE(plain.values.contains("optimize_time"));
  const CellResult optimized = result_of(plan, 1);
  EXPECT_EQ(optimized.values.at("optimize_time").samples.size(), 3U);
  EXPECT_TRUE(optimized.values.contains("optimize_time:test-optimizer#2"));
  const Series& series = optimized.series.at("cost_over_time");
  EXPECT_EQ(series.y, (std::vector<double>{100, 90, 100, 90})) << "both optimizers, one after the other";
  EXPECT_TRUE(std::is_sorted(series.x.begin(), series.x.end()));
}

TEST_F(RunTest, TimesOfADeviceTakeThePlaceOfTheWallClocks) {
  Plan plan = test_plan({"device", "good"});
  add_traces(plan, {"device"});
  EXPECT_EQ(run_plan(plan, options).done, 3U) << log();
  const CellResult built = result_of(plan, 0);
  const std::vector<double> thrice(3, 3);
  EXPECT_EQ(built.values.at("build_time").samples, thrice);
  EXPECT_EQ(built.values.at("total_time").samples, thrice);
  EXPECT_EQ(built.values.at("build_time:sort").samples, std::vector<double>(3, 1));
  EXPECT_EQ(built.values.at("build_time:split").samples, std::vector<double>(3, 2));
  EXPECT_EQ(built.values.at("upload_time").samples, std::vector<double>(3, 0.5));
  EXPECT_EQ(built.values.at("download_time").samples, std::vector<double>(3, 0.25));
  EXPECT_EQ(built.values.at("device_memory").samples, std::vector<double>{4096});
  EXPECT_EQ(built.series.at("level_time"), (Series{"level", "1", "s", {1, 2}, {2, 1}}));
  EXPECT_EQ(built.series.at("level_active"), (Series{"level", "1", "1", {1, 2}, {1, 2}}));
  EXPECT_FALSE(result_of(plan, 1).values.contains("upload_time"));
  EXPECT_EQ(result_of(plan, 2).values.at("trace_time").samples, std::vector<double>(3, 5));
}

TEST_F(RunTest, EveryResultSaysWhereItComesFrom) {
  const Plan plan = test_plan({"good"});
  (void)run_plan(plan, options);
  const auto provenance = result_of(plan, 0).provenance;
  for (const char* key :
       {"commit", "dirty", "code_hash", "compiler", "flags", "cpu", "microcode", "kernel", "governor", "turbo", "threads", "seed",
        "scene_hash", "command", "date", "library embree", "library TBB", "library benchmark"}) {
    EXPECT_TRUE(provenance.contains(key) && !provenance.at(key).empty()) << key;
  }
  EXPECT_EQ(provenance.at("command"), "raystudy run test.yaml");
  EXPECT_EQ(provenance.at("scene_hash").size(), 32U);
}

TEST_F(RunTest, EachMethodHasItsOwnThreads) {
  Plan plan = test_plan({"threads: 1, 1", "threads: 2, 2", "threads: 3, 3"});
  plan.pipelines[1].threads = 2;
  plan.pipelines[2].threads = 3;
  EXPECT_EQ(run_plan(plan, options).done, 3U) << log();
  EXPECT_EQ(result_of(plan, 0).provenance.at("threads"), "1");
  EXPECT_EQ(result_of(plan, 2).provenance.at("threads"), "3");
}

TEST_F(RunTest, AFailureIsARowWithItsCauseAndTheOthersGoOn) {
  Plan plan = test_plan({"crash", "abort", "throw", "wrong tree", "exits", "good"});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(summary.failed, 5U);
  EXPECT_EQ(result_of(plan, 0).reason, "crashed: SIGSEGV while building");
  EXPECT_EQ(result_of(plan, 0).status, CellStatus::failed);
  EXPECT_EQ(result_of(plan, 1).reason, "crashed: SIGABRT while building");
  EXPECT_EQ(result_of(plan, 2).reason, "error while building: no such luck; expected more of it");
  EXPECT_THAT(result_of(plan, 3).reason, testing::StartsWith("wrong tree: "));
  EXPECT_EQ(result_of(plan, 4).reason, "crashed: exit code 7 while building");
  EXPECT_EQ(result_of(plan, 5).status, CellStatus::done);
}

TEST_F(RunTest, ACrashInALaterRepetitionCostsItsOwnCellOnly) {
  const Plan plan = test_plan({"good", "crash later", "throw later"});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(result_of(plan, 1).reason, "crashed: SIGSEGV while building");
  EXPECT_EQ(result_of(plan, 2).reason, "error while building: no luck the second time");
}

TEST_F(RunTest, ACellThatTakesTooLongIsEnded) {
  Plan plan = test_plan({"sleep", "good"});
  plan.timeout_seconds = 1.5;
  const auto start = std::chrono::steady_clock::now();
  const RunSummary summary = run_plan(plan, options);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(result_of(plan, 0).reason, "timed out after 1.5 s while building");
}

TEST_F(RunTest, ASceneThatTakesTooLongToOpenFailsItsCellsOnly) {
  Plan plan = test_plan({"good"});
  plan.timeout_seconds = 1.5;
  plan.scenes.push_back({"endless", "endless", "endless", 0, 1, "endless", {}});
  plan.cells.push_back({1, 0, {}, {}});
  options.open = [](const SceneSpec& spec) {
    if (spec.name == "endless") std::this_thread::sleep_for(std::chrono::hours(1));
    return open_test_scene(spec);
  };
  EXPECT_EQ(run_plan(plan, options).done, 1U);
  EXPECT_EQ(result_of(plan, 1).status, CellStatus::failed);
  EXPECT_EQ(result_of(plan, 1).reason, "timed out after 1.5 s while opening the scene");
}

TEST_F(RunTest, WhatAKilledRunLeftHalfWrittenGoes) {
  const Plan plan = test_plan({"good"});
  (void)run_plan(plan, options);
  const pid_t dead = fork();
  if (dead == 0) _exit(0);
  waitpid(dead, nullptr, 0);
  const fs::path left = results_folder(plan, folder) / fmt::format(".0123.json.{}.tmp", dead);
  std::ofstream(left) << "{\"format\": 1,";
  fs::last_write_time(left, fs::file_time_type::clock::now() - std::chrono::hours(1));
  EXPECT_EQ(run_plan(plan, options).reused, 1U);
  EXPECT_FALSE(fs::exists(left));
}

TEST_F(RunTest, ACellThatTakesTooMuchMemoryIsEnded) {
  if (!MemoryLimit::is_enforced()) GTEST_SKIP() << "a sanitizer's allocator knows no limit";
  Plan plan = test_plan({"eat memory", "eat memory in noexcept", "good"});
  plan.memory_limit_bytes = 256 * 1024 * 1024;
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(result_of(plan, 0).reason, "out of memory while building (limit 256 MiB)");
  EXPECT_EQ(result_of(plan, 1).reason, "out of memory while building (limit 256 MiB)");
}

TEST_F(RunTest, PeakMemoryOfABuildIsWhatItHeldAtOnce) {
  if (!MemoryLimit::is_enforced()) GTEST_SKIP() << "a sanitizer's own memory would count";
  const Plan plan = test_plan({"good", "hold 64 MiB"});
  (void)run_plan(plan, options);
  const double little = result_of(plan, 0).values.at("peak_memory").median();
  const double much = result_of(plan, 1).values.at("peak_memory").median();
  EXPECT_NEAR(much - little, 64.0 * 1024 * 1024, 4.0 * 1024 * 1024);
}

TEST_F(RunTest, TracesAreCheckedCountedAndTimed) {
  Plan plan = test_plan({"good"});
  add_traces(plan, {"good", "count"});
  EXPECT_EQ(run_plan(plan, options).done, 3U);
  const CellResult plain = result_of(plan, 1);
  EXPECT_EQ(plain.tracer, "good");
  EXPECT_EQ(plain.workload, "down");
  EXPECT_EQ(plain.values.at("ray_count").median(), 2 * test_triangles);
  EXPECT_EQ(plain.values.at("hit_share").median(), 0.5);
  EXPECT_EQ(plain.values.at("trace_time").samples.size(), 3U);
  EXPECT_DOUBLE_EQ(plain.values.at("trace_rate").samples[1] * plain.values.at("trace_time").samples[1], 2 * test_triangles);
  EXPECT_FALSE(plain.values.contains("steps_per_ray"));
  const CellResult counted = result_of(plan, 2);
  EXPECT_EQ(counted.values.at("steps_per_ray"), (Measurement{ValueClass::exact, "1", {5}}));
  EXPECT_EQ(counted.values.at("inner_nodes_per_ray").median(), 3);
  EXPECT_EQ(counted.values.at("leaves_per_ray").median(), 2);
  EXPECT_EQ(counted.values.at("box_tests_per_ray").median(), 7);
  EXPECT_EQ(counted.values.at("triangle_tests_per_ray").median(), 5);
}

TEST_F(RunTest, AWrongHitOrAFailingTracerIsARowWithItsCause) {
  Plan plan = test_plan({"good"});
  plan.timeout_seconds = 2;
  add_traces(plan, {"miss one", "hit too far", "crash", "throw later", "sleep later", "good"});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 2U);
  EXPECT_EQ(summary.failed, 5U);
  EXPECT_EQ(result_of(plan, 1).reason,
            "wrong hits: 1 of 128 closest-hit rays: ray 3 from (1.75, 1, 0.5) along (0, -1, 0), t in [0, 10]: found nothing, the "
            "reference triangle 3 at t = 1 (u = 0.5, v = 0.25), exact arithmetic triangle 3 at t = 1");
  EXPECT_THAT(result_of(plan, 2).reason, testing::StartsWith("wrong hits: 1 of 128 closest-hit rays: ray 5 from (2.75, 1, 0.5)"));
  EXPECT_EQ(result_of(plan, 3).reason, "crashed: SIGSEGV while tracing");
  EXPECT_EQ(result_of(plan, 4).reason, "error while tracing: lost the way");
  EXPECT_EQ(result_of(plan, 5).reason, "timed out after 2 s while tracing");
}

TEST_F(RunTest, AFailingBuildFailsItsTracesAndAFailingWorkloadItsOwn) {
  Plan plan = test_plan({"throw"});
  add_traces(plan, {"good"});
  (void)run_plan(plan, options);
  EXPECT_EQ(result_of(plan, 1).reason, "error while building: no such luck; expected more of it");
  Plan rayless = test_plan({"good"});
  add_traces(rayless, {"good"}, true);
  rayless.name = "rayless";
  const RunSummary summary = run_plan(rayless, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(result_of(rayless, 1).reason, "error while making the rays: no rays today");
}

TEST_F(RunTest, MetricsBecomeValuesAndSeries) {
  Plan plan = test_plan({"good"});
  add_metric(plan, "good");
  (void)run_plan(plan, options);
  const CellResult result = result_of(plan, 0);
  EXPECT_EQ(result.values.at("answer"), (Measurement{ValueClass::exact, "1", {42}}));
  EXPECT_EQ(result.series.at("by_depth"), (Series{"depth", "1", "m", {0, 1, 2}, {1, 2, 4}}));
  plan.metrics.clear();
  add_metric(plan, "not finite");
  options.force = true;
  EXPECT_EQ(run_plan(plan, options).failed, 1U);
  EXPECT_EQ(result_of(plan, 0).reason, "error while measuring the tree: metric 'test-metric' gave a 'answer' that is not finite");
}

TEST_F(RunTest, ReusesWhatIsDoneTriesAgainWhatFailedAndForceMeasuresAll) {
  const Plan plan = test_plan({"good", "throw"});
  (void)run_plan(plan, options);
  const std::string date = "an earlier day";
  CellResult marked = result_of(plan, 0);
  marked.provenance["date"] = date;
  write_result(results_folder(plan, folder), marked);
  const RunSummary again = run_plan(plan, options);
  EXPECT_EQ(again.reused, 1U);
  EXPECT_EQ(again.done, 0U);
  EXPECT_EQ(again.failed, 1U);
  EXPECT_EQ(result_of(plan, 0).provenance.at("date"), date);
  options.force = true;
  EXPECT_EQ(run_plan(plan, options).done, 1U);
  EXPECT_NE(result_of(plan, 0).provenance.at("date"), date);
}

TEST_F(RunTest, ACorruptResultIsSaidAndMeasuredAgain) {
  const Plan plan = test_plan({"good"});
  (void)run_plan(plan, options);
  const fs::path file = result_file(results_folder(plan, folder), cell_id(plan, plan.cells[0]));
  std::ofstream(file) << "{\"format\": 1,";
  const RunSummary again = run_plan(plan, options);
  EXPECT_EQ(again.done, 1U);
  EXPECT_THAT(log(), HasSubstr(fmt::format(
                         "{}:1:14: the result breaks off; expected a result as 'raystudy run' writes it (delete the file "
                         "to have its cell measured again); measured again\n",
                         file.string())));
  EXPECT_EQ(result_of(plan, 0).status, CellStatus::done);
}

TEST_F(RunTest, AMissingSceneIsARow) {
  Plan plan = test_plan({"good"});
  plan.scenes[0].name = "missing";
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.missing, 1U);
  EXPECT_EQ(result_of(plan, 0).status, CellStatus::missing);
  EXPECT_EQ(result_of(plan, 0).reason, "scene not installed: raystudy scene get missing");
}

TEST_F(RunTest, ASceneThatCannotBeReadFailsItsCellsOnly) {
  Plan plan = test_plan({"good"});
  plan.scenes.push_back({"broken", "broken", "broken", 0, 1, "broken", {}});
  plan.cells.push_back({1, 0, {}, {}});
  const RunSummary summary = run_plan(plan, options);
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(result_of(plan, 1).reason, "error while opening the scene: broken.ply:3: the file ends in the middle of a vertex");
}

TEST_F(RunTest, AnUnwritableFolderIsRefusedBeforeAnythingIsMeasured) {
  const Plan plan = test_plan({"good"});
  std::ofstream(folder / "file") << "x";
  options.results = folder / "file";
  try {
    (void)run_plan(plan, options);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), fmt::format("{}: cannot make the folder: Not a directory", (folder / "file" / "test").string()));
  }
}

TEST_F(RunTest, ExportsGoogleBenchmarksOwnFormat) {
  const Plan plan = test_plan({"good", "throw"});
  (void)run_plan(plan, options);
  std::stringstream text;
  text << std::ifstream(results_folder(plan, folder) / "google-benchmark" / "strip.json").rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("\"run_name\": \"good/build\""));
  EXPECT_THAT(text.str(), HasSubstr("\"repetition_index\": 2"));
  EXPECT_THAT(text.str(), testing::Not(HasSubstr("throw")));
}

/// SIGINT comes while the second of three builds sleeps.
TEST_F(RunTest, AnInterruptEndsAtOnceAndKeepsWhatIsMeasured) {
  Plan plan = test_plan({"good"});
  plan.pipelines.push_back(test_pipeline("sleep"));
  plan.scenes.push_back({"strip2", "strip2", "strip", 0, 1, "strip", {}});
  plan.cells.push_back({1, 1, {}, {}});
  const pid_t self = getpid();
  const pid_t killer = fork();
  if (killer == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    kill(self, SIGINT);
    _exit(0);
  }
  const auto start = std::chrono::steady_clock::now();
  const RunSummary summary = run_plan(plan, options);
  EXPECT_TRUE(summary.interrupted);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
  EXPECT_EQ(summary.done, 1U);
  EXPECT_EQ(summary.left, 1U);
  EXPECT_EQ(result_of(plan, 0).status, CellStatus::done);
  EXPECT_FALSE(fs::exists(result_file(results_folder(plan, folder), cell_id(plan, plan.cells[1]))));
}

}  // namespace
}  // namespace raystudy
