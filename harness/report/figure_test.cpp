#include "harness/report/figure.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "harness/report/test_study.h"
#include "harness/report/vega.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// An environment variable for the length of a test.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    ::setenv(name, value.c_str(), 1);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() {
    if (old_) {
      ::setenv(name_, old_->c_str(), 1);
    } else {
      ::unsetenv(name_);
    }
  }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

class FigureTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / "figure_test" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    figure.name = "figure7";
    figure.kind = "depth-histogram";
    figure.caption = "Areas";
    figure.methods = {"sah", "insertion"};
    figure.scenes = {"sibenik-ogre"};
    figure.styles = {{"sah", "red dashed"}, {"insertion", "#008000"}};
    figure.where = {"test.yaml", 30, 3};
    for (CellResult& r : results) {
      r.series["inner_area_by_depth"] = {"depth", "1", "1", {0, 1}, {1, 1.5}};
      r.series["leaf_area_by_depth"] = {"depth", "1", "1", {0, 1}, {0, 0.25}};
      r.series["cost_over_time"] = {"seconds", "s", "1", {0, 0.5}, {100, 80}};
      r.values["triangles"] = {ValueClass::exact, "1", {1000}};
    }
  }
  [[nodiscard]] Report report() {
    plan.figures = {figure};
    return {plan, results};
  }
  json spec() {
    gaps.clear();
    const std::string text = figure_spec(figure, report(), gaps);
    return text.empty() ? json{} : json::parse(text);
  }

  Plan plan = test_plan();
  FigureSpec figure;
  std::vector<CellResult> results = test_results();
  std::vector<std::string> gaps;
  fs::path folder;
};

TEST_F(FigureTest, ADepthHistogramHasAPanelForInnerNodesAndOneForLeaves) {
  const json s = spec();
  EXPECT_EQ(s["title"], "Areas");
  EXPECT_EQ(s["data"]["values"].size(), 8U);
  EXPECT_EQ(s["data"]["values"][1],
            (json{{"scene", "sibenik-ogre"}, {"method", "sah"}, {"nodes", "inner nodes"}, {"depth", 1}, {"area", 1.5}}));
  EXPECT_EQ(s["facet"]["column"]["sort"], (json{"inner nodes", "leaves"}));
  EXPECT_FALSE(s["facet"].contains("row"));
  const json& encoding = s["spec"]["encoding"];
  EXPECT_EQ(encoding["color"]["scale"]["domain"], (json{"sah", "insertion"}));
  EXPECT_EQ(encoding["color"]["scale"]["range"], (json{"red", "#008000"}));
  EXPECT_EQ(encoding["strokeDash"]["scale"]["range"], json::parse("[[7, 4], [1, 0]]"));
  EXPECT_THAT(gaps, testing::IsEmpty());
}

TEST_F(FigureTest, SeveralScenesAreRowsAndWhatIsMissingIsSaid) {
  figure.scenes = {"sibenik-ogre", "sponza-dabrovic", "atrium"};
  results.front().series.erase("leaf_area_by_depth");
  const json s = spec();
  EXPECT_EQ(s["facet"]["row"]["field"], "scene");
  EXPECT_THAT(gaps, testing::ElementsAre("sibenik-ogre, sah: no series 'leaf_area_by_depth'", "sponza-dabrovic, sah: not run",
                                         "sponza-dabrovic, insertion: not run", "atrium, insertion: timed out after 60 s"));
  figure.scenes = {"sponza-dabrovic"};
  EXPECT_TRUE(spec().empty());
}

TEST_F(FigureTest, ALineIsASeriesOverItsAxis) {
  figure.kind = "line";
  figure.options = {{"y", "cost_over_time"}, {"x", "axis"}, {"log_x", "false"}, {"log_y", "false"}};
  EXPECT_EQ(spec()["data"]["values"].size(), 4U);
  EXPECT_EQ(spec()["encoding"]["x"]["title"], "time [s]");
  EXPECT_EQ(spec()["encoding"]["y"]["title"], "cost");
  figure.options["log_x"] = "true";
  const json s = spec();
  EXPECT_EQ(s["encoding"]["x"]["scale"]["type"], "log");
  EXPECT_EQ(s["data"]["values"].size(), 2U);
  EXPECT_THAT(gaps, testing::ElementsAre("2 points at 0 have no place on a logarithmic axis"));
}

TEST_F(FigureTest, ALineCanBeANumberOverTriangles) {
  figure.kind = "line";
  figure.options = {{"y", "total_time"}, {"x", "triangles"}, {"log_x", "true"}, {"log_y", "true"}};
  const json s = spec();
  EXPECT_EQ(s["data"]["values"][0],
            (json{{"scene", "sibenik-ogre"}, {"method", "sah"}, {"x", 1000}, {"y", 0.052}, {"low", 0.05}, {"high", 0.06}}));
  EXPECT_EQ(s["layer"].size(), 3U) << "line, points, intervals; one point has no power";
  EXPECT_EQ(s["layer"][0]["encoding"]["y"]["title"], "total time [s]");
  figure.options["y"] = "nothing";
  EXPECT_TRUE(spec().empty());
  EXPECT_THAT(gaps, testing::Contains("sibenik-ogre, sah: no 'nothing'"));
}

/// Times 1, 8 and 16 s over 1000, 4000 and 16000 triangles: with x = -1, 0, 1 (powers of 4) and y = 0, 3, 4 (powers of 2) the
/// least-squares slope is (4 - 0) / 2 powers of 2 a power of 4, so 1. The reference N^1.5 ends at 16^1.5 = 64 times the first.
TEST_F(FigureTest, GrowthIsFittedAndHeldAgainstAReference) {
  figure.kind = "line";
  figure.methods = {"sah"};
  figure.options = {{"y", "total_time"}, {"x", "triangles"}, {"log_x", "true"}, {"log_y", "true"}, {"reference_exponent", "1.5"}};
  figure.scenes.clear();
  plan.scenes.clear();
  results.clear();
  for (const auto& [triangles, seconds] : {std::pair{1000.0, 1.0}, {4000.0, 8.0}, {16000.0, 16.0}}) {
    SceneSpec scene;
    scene.base = "atrium";
    scene.label = fmt::format("atrium[triangles={}]", triangles);
    plan.scenes.push_back(scene);
    figure.scenes.push_back(scene.label);
    CellResult result;
    result.scene = scene.label;
    result.method = "sah";
    result.values["triangles"] = {ValueClass::exact, "1", {triangles}};
    result.values["total_time"] = {ValueClass::absolute, "s", {seconds}};
    results.push_back(result);
  }
  const json rows = spec()["data"]["values"];
  ASSERT_EQ(rows.size(), 6U);
  EXPECT_EQ(rows[3], (json{{"scene", "atrium"}, {"method", "sah"}, {"x", 16000}, {"y", 16}, {"exponent", "N^1.00"}}));
  EXPECT_EQ(rows[4], (json{{"scene", "atrium"}, {"method", "sah"}, {"x", 1000}, {"y", 1}, {"reference", "sah"}}));
  EXPECT_NEAR(rows[5]["y"].get<double>(), 64, 1e-9);
  EXPECT_EQ(spec()["title"]["subtitle"], (json{"atrium", "N^x: the power of the triangles that fits best; grey: N^1.5"}));
  figure.options["reference_exponent"] = "0";
  EXPECT_EQ(spec()["data"]["values"].size(), 4U);
  // A second curve that ends close by: 14 pixels of 300 stand between the texts, half of what was lacking below, half above.
  for (CellResult result : std::vector<CellResult>(results)) {
    result.method = "insertion";
    for (double& seconds : result.values["total_time"].samples) seconds *= seconds == 16 ? 1.01 : 1;
    results.push_back(result);
  }
  figure.methods.emplace_back("insertion");
  std::vector<double> heights;
  const json both = spec()["data"]["values"];
  for (const json& row : both) {
    if (row.contains("exponent")) heights.push_back(row["y"]);
  }
  ASSERT_EQ(heights.size(), 2U);
  EXPECT_NEAR(std::log(heights[1] / heights[0]), std::log(16.16) * 14 / 300, 1e-9);
  EXPECT_NEAR(heights[0] * heights[1], 16 * 16.16, 1e-9);
}

/// Times of three methods, the second beaten by the first in both.
TEST_F(FigureTest, AParetoPlotHasAFrontAndLabels) {
  figure.kind = "pareto";
  figure.tracer = own_tracer;
  figure.methods = {"fast", "beaten", "good", "absent"};
  figure.scenes = {"atrium", "conference"};
  figure.workloads = {"random"};
  plan.pipelines.clear();
  results.clear();
  for (const char* method : {"fast", "beaten", "good", "absent"}) {
    PipelineSpec& pipeline = plan.pipelines.emplace_back();
    pipeline.label = pipeline.base = method;
    pipeline.builder.name = std::string(method) == "good" ? "sweep-sah" : "embree";
    pipeline.tracers = {"t"};
  }
  for (const auto& [method, seconds, rate] : {std::tuple{"fast", 0.001, 1e6}, {"beaten", 0.002, 0.5e6}, {"good", 0.004, 4e6}}) {
    results.push_back(test_result("atrium", method, 1, {seconds, seconds, seconds}));
    CellResult traced = test_result("atrium", method, 1, {});
    traced.tracer = "t";
    traced.workload = "random";
    traced.values = {{"trace_rate", {ValueClass::absolute, "rays/s", {rate, rate, rate}}}};
    results.push_back(traced);
  }
  const json s = spec();
  ASSERT_EQ(s["concat"].size(), 1U) << "nothing is known of the other scene";
  const json& panel = s["concat"][0];
  EXPECT_EQ(panel["title"]["text"], "atrium");
  EXPECT_EQ(
      panel["layer"][0]["data"]["values"],
      (json::parse(
          R"([{"x": 1.0, "y": 1000.0, "order": 0}, {"x": 4.0, "y": 1000.0, "order": 1}, {"x": 4.0, "y": 250.0, "order": 2}])")))
      << "the stairs of the front";
  const json& points = panel["layer"][1];
  EXPECT_EQ(points["data"]["values"][1],
            (json{{"method", "beaten"}, {"builder", "embree"}, {"x", 2.0}, {"y", 2000.0}, {"front", false}}));
  EXPECT_EQ(points["encoding"]["color"]["scale"]["domain"], (json{"embree", "sweep-sah"}));
  EXPECT_EQ(points["encoding"]["shape"]["scale"]["range"][0], "diamond");
  EXPECT_EQ(points["encoding"]["x"]["title"], "time to build [ms]");
  EXPECT_EQ(points["encoding"]["y"]["title"], "time to trace a ray, random [ns]");
  const json& labels = panel["layer"].back();
  EXPECT_EQ(labels["data"]["values"].size(), 3U);
  EXPECT_EQ(labels["data"]["values"][0]["method"], "fast") << "those on the front first";
  EXPECT_THAT(gaps, testing::Contains("atrium, absent: not run"));
  results.clear();
  EXPECT_TRUE(spec().empty());
}

TEST_F(FigureTest, ATracedNumberOverTriangles) {
  figure.kind = "line";
  figure.methods = {"sah"};
  figure.options = {{"y", "trace_time"}, {"x", "triangles"}};
  figure.tracer = own_tracer;
  figure.workloads = {"random"};
  plan.pipelines[0].tracers = {"t"};
  CellResult traced = test_result("sibenik-ogre", "sah", 1, {});
  traced.tracer = "t";
  traced.workload = "random";
  traced.values = {{"trace_time", {ValueClass::absolute, "s", {0.5}}}};
  results.push_back(traced);
  EXPECT_EQ(spec()["data"]["values"], json::parse(R"([{"scene": "sibenik-ogre", "method": "sah", "x": 1000.0, "y": 0.5}])"));
  figure.workloads = {"primary"};
  EXPECT_TRUE(spec().empty());
  EXPECT_THAT(gaps, testing::ElementsAre("sibenik-ogre, sah, t, primary: not run"));
}

TEST_F(FigureTest, AStyleIsAColourAndADash) {
  EXPECT_EQ(curve_style(figure, 0).color, "red");
  EXPECT_EQ(curve_style(figure, 0).dash, (std::vector<int>{7, 4}));
  figure.styles.erase("insertion");
  EXPECT_EQ(curve_style(figure, 1).color, "#d55e00");
  figure.styles["sah"] = "redd dotted";
  try {
    (void)curve_style(figure, 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "test.yaml:30:3: style of 'sah' in figure 'figure7' has 'redd'; expected a colour (#rrggbb or a name), then solid, "
        "dashed or dotted");
  }
}

TEST_F(FigureTest, NamesTheNearestFigure) {
  try {
    (void)write_figures(report(), folder, "figrue7");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), plan.file + ": there is no figure 'figrue7'; expected one of figure7; did you mean 'figure7'?");
  }
  plan.figures.clear();
  try {
    (void)write_figures(Report(plan, results), folder, "figure7");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), plan.file + ": there is no figure 'figure7'; expected an experiment with figures");
  }
}

TEST_F(FigureTest, AFolderThatCannotBeWrittenIsAnError) {
  try {
    (void)write_figures(report(), "/proc/figures");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("/proc/figures: "));
  }
}

TEST_F(FigureTest, WithoutNodeOrPackagesTheSpecificationIsWrittenAndTheErrorSaysWhatToInstall) {
  const Variable modules("RAYSTUDY_VEGA", (folder / "empty").string());
  {
    const Variable path("PATH", folder.string());
    EXPECT_EQ(vega_problem(), "figures need node: apt-get install nodejs npm");
  }
  fs::create_directories(folder / "bin");
  fs::create_symlink("/bin/true", folder / "bin" / "node");
  const Variable path("PATH", (folder / "bin").string());
  const std::string to = (folder / "empty").string();
  const std::string from = RAYSTUDY_SOURCE_DIR "/harness/report/vega";
  const std::string problem = "figures need the npm package vega in " + to + "/node_modules: mkdir -p " + to + " && cp " + from +
                              "/package.json " + from + "/package-lock.json " + to + " && npm ci --prefix " + to;
  EXPECT_EQ(vega_problem(), problem);
  const std::vector<FigureOutcome> outcomes = write_figures(report(), folder);
  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_TRUE(outcomes[0].failed);
  EXPECT_EQ(outcome_text(outcomes[0]),
            "figure figure7: not drawn " + (folder / "figure7.vl.json").string() + "\n  not shown: " + problem + "\n");
  EXPECT_TRUE(fs::exists(folder / "figure7.vl.json"));
  for (const char* package : {"vega", "vega-lite"}) {
    fs::create_directories(folder / "empty/node_modules" / package);
    fs::create_symlink("/bin/true", folder / "empty/node_modules" / package / "package.json");
  }
  EXPECT_EQ(vega_problem(), "figures need rsvg-convert: apt-get install librsvg2-bin");
}

TEST_F(FigureTest, IsDrawnWhereVegaIsInstalled) {
  if (const std::string problem = vega_problem(); !problem.empty()) GTEST_SKIP() << problem;
  const std::vector<FigureOutcome> outcomes = write_figures(report(), folder);
  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_FALSE(outcomes[0].failed) << outcome_text(outcomes[0]);
  EXPECT_GT(fs::file_size(folder / "figure7.svg"), 1000U);
  EXPECT_GT(fs::file_size(folder / "figure7.png"), 1000U);
}

TEST_F(FigureTest, WhatVegaFindsWrongIsAnError) {
  if (const std::string problem = vega_problem(); !problem.empty()) GTEST_SKIP() << problem;
  fs::create_directories(folder);
  std::ofstream(folder / "x.vl.json") << R"({"data": {"values": []}, "mark": "line", "encoding": {"xx": {"field": "a"}}})";
  try {
    render_vega(folder / "x.vl.json");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "node failed: xx-encoding is dropped as xx is not a valid encoding channel.");
  }
}

}  // namespace
}  // namespace raystudy
