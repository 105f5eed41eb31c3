#include "harness/report/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/report/test_study.h"
#include "harness/report/value.h"

namespace raystudy {
namespace {

class TableTest : public testing::Test {
 protected:
  [[nodiscard]] ReportTable build() const {
    std::vector<ReportTable> tables = build_tables(plan, ResultSet(results), &*published);
    return tables.front();
  }
  /// Row 0 is sibenik-ogre, 1 sponza-dabrovic, 2 conference, 3 atrium.
  [[nodiscard]] static const ReportCell& cell(const ReportTable& table, std::size_t row, std::size_t column) {
    return table.rows.at(row).cells.at(column);
  }
  CellResult& result(const std::string& scene, const std::string& method) {
    for (CellResult& r : results) {
      if (r.scene == scene && r.method == method) return r;
    }
    throw std::logic_error("no such result");
  }
  static std::string error_of(const Plan& wrong, const Published* p) {
    try {
      (void)build_tables(wrong, ResultSet(test_results()), p);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  Plan plan = test_plan();
  std::vector<CellResult> results = test_results();
  std::optional<Published> published = published_of(plan);
};

TEST_F(TableTest, APublishedCellHasBothNumbersTheirRatioAndAVerdict) {
  const ReportTable table = build();
  const ReportCell& cost = cell(table, 0, 0);
  EXPECT_EQ(cost.published->text, "82.30");
  EXPECT_EQ(cost.ours->value, 82.21);
  EXPECT_FALSE(cost.ours->interval);
  EXPECT_DOUBLE_EQ(*cost.ratio, 82.21 / 82.30);
  EXPECT_EQ(cost.verdict, Verdict::match);
  EXPECT_EQ(cost.value_class, ValueClass::exact);
}

TEST_F(TableTest, ARelativeCellIsDividedByItsBaseline) {
  const ReportTable table = build();
  EXPECT_DOUBLE_EQ(cell(table, 0, 1).ours->value, 69.8 / 82.21 * 100);
  EXPECT_EQ(cell(table, 0, 1).value_class, ValueClass::exact);
  EXPECT_EQ(cell(table, 0, 1).verdict, Verdict::match);
  const ReportCell& time = cell(table, 0, 3);
  EXPECT_DOUBLE_EQ(time.ours->value, 0.41 / 0.052 * 100);
  EXPECT_EQ(time.value_class, ValueClass::ratio);
  EXPECT_DOUBLE_EQ(time.ours->interval->low, 0.4 / 0.06 * 100);
  EXPECT_DOUBLE_EQ(time.ours->interval->high, 0.45 / 0.05 * 100);
  EXPECT_EQ(time.verdict, Verdict::trend);
}

TEST_F(TableTest, AnAbsoluteCellBelongsToItsMachine) {
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 2).value_class, ValueClass::absolute);
  EXPECT_EQ(cell(table, 0, 2).ours->value, 0.052);
  EXPECT_EQ(cell(table, 0, 2).verdict, Verdict::not_comparable);
  EXPECT_THAT(table.remarks, testing::Contains("Machine: A fast one, 1 thread"));
}

TEST_F(TableTest, OfAVariantOnlyTheRatioIsCompared) {
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 2, 0).verdict, Verdict::not_comparable);
  EXPECT_EQ(cell(table, 2, 1).verdict, Verdict::trend);
}

TEST_F(TableTest, WhatIsNotThereSaysWhy) {
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 1, 0).absence, "not run");
  EXPECT_EQ(cell(table, 1, 0).published->text, "220.20");
  EXPECT_EQ(cell(table, 1, 0).verdict, Verdict::none);
  EXPECT_EQ(cell(table, 3, 1).absence, "failed");
  EXPECT_EQ(cell(table, 3, 1).reason, "atrium, insertion: timed out after 60 s");
  EXPECT_FALSE(cell(table, 3, 0).published);
  EXPECT_EQ(cell(table, 3, 0).ours->value, 50.125);
}

TEST_F(TableTest, AMissingSceneIsAVisibleRow) {
  result("sibenik-ogre", "sah").status = CellStatus::missing;
  result("sibenik-ogre", "sah").reason = "scene not installed: raystudy scene get sibenik-ogre";
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 0).absence, "not installed");
  EXPECT_EQ(cell(table, 0, 0).reason, "scene not installed: raystudy scene get sibenik-ogre");
  EXPECT_EQ(cell(table, 0, 1).absence, "not installed");
  EXPECT_EQ(table.rows.at(4).label, "Fairy Forest");
  EXPECT_EQ(cell(table, 4, 0).published->text, "95.10");
  EXPECT_EQ(cell(table, 4, 0).reason, "scene not in this experiment: Fairy Forest is our 'fairy-forest'");
  EXPECT_EQ(table.rows.size(), 4U + 6U);
}

TEST_F(TableTest, APaperSceneThatNobodyKnowsIsARowToo) {
  published->scenes.at(1).ours.clear();
  published->scenes.at(1).comparability = Comparability::unverified;
  published->scenes.at(1).reason = "no file of this scene is known to the catalog";
  const ReportTable table = build();
  EXPECT_EQ(table.rows.at(4).label, "Fairy Forest");
  EXPECT_EQ(cell(table, 4, 0).reason, "scene not installed: no file of this scene is known to the catalog");
}

TEST_F(TableTest, APaperSceneOutsideTheExperimentSaysSo) {
  plan.scenes.erase(plan.scenes.begin() + 2);
  const ReportTable table = build();
  EXPECT_EQ(table.rows.at(3).label, "Conference");
  EXPECT_EQ(cell(table, 3, 0).reason, "scene not in this experiment: Conference is our 'conference'");
}

TEST_F(TableTest, TimesOfTwoMachinesHaveNoRatio) {
  result("sibenik-ogre", "insertion").provenance["cpu"] = "A slow one";
  const ReportTable table = build();
  EXPECT_FALSE(cell(table, 0, 3).ours);
  EXPECT_EQ(cell(table, 0, 3).reason, "times of different machines have no ratio: cpu: A slow one and A fast one");
  EXPECT_EQ(cell(table, 0, 1).verdict, Verdict::match) << "an exact ratio does not depend on machines";
  EXPECT_THAT(table.remarks, testing::IsSupersetOf({"Machine: A fast one, 1 thread", "Machine: A slow one, 1 thread"}));
}

TEST_F(TableTest, ADeviceIsNamedWithItsDriver) {
  result("sibenik-ogre", "insertion").provenance["device"] = "A card";
  result("sibenik-ogre", "insertion").provenance["driver"] = "a driver 1.0";
  EXPECT_THAT(build().remarks, testing::Contains("Device: A card, a driver 1.0"));
}

TEST_F(TableTest, TimesOfTwoRunsSayThatTheyWereNotInterleaved) {
  result("sibenik-ogre", "insertion").provenance["timing_group"] = "2";
  EXPECT_EQ(cell(build(), 0, 3).reason,
            "measured in different runs, not interleaved; only the direction is compared: the times of another "
            "implementation on other hardware");
}

TEST_F(TableTest, ABaselineOfZeroHasNoRatio) {
  result("sibenik-ogre", "sah").values["cost"].samples = {0};
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 1).absence, "none");
  EXPECT_EQ(cell(table, 0, 1).reason, "'cost' of 'sah' is 0");
}

TEST_F(TableTest, APublishedZeroHasNoRatio) {
  for (PublishedColumn& column : published->columns) {
    if (column.key() == "table1.cost") column.values.at("Sibenik Cathedral") = {0, "0.0"};
  }
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 0).published->text, "0.0");
  EXPECT_EQ(cell(table, 0, 0).ours->value, 82.21);
  EXPECT_FALSE(cell(table, 0, 0).ratio);
}

TEST_F(TableTest, AMetricThatAMethodDoesNotHave) {
  result("sibenik-ogre", "sah").values.erase("cost");
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 0).absence, "none");
  EXPECT_EQ(cell(table, 0, 0).reason, "this method has no 'cost'");
}

TEST_F(TableTest, MethodsOfARowArePeers) {
  plan.tables.front().columns[1].relative_to.clear();
  plan.tables.front().columns[1].published = "table1.cost";
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 1).verdict, Verdict::differs)
      << "both columns are published with the same number, so there is no order";
}

TEST_F(TableTest, EachMethodOfARowMayBeTracedByItsOwnTracer) {
  TableSpec& table = plan.tables.front();
  table.rows = "method";
  table.columns.resize(1);
  ColumnSpec& column = table.columns.front();
  column.metric = "trace_rate";
  column.methods.clear();
  column.published.clear();
  column.tracer = own_tracer;
  column.unit = "rays/s";
  column.workload = "primary";
  plan.pipelines[0].tracers = {"scalar"};
  plan.pipelines[1].tracers = {"scalar", "embree"};  // not one of its own
  for (const auto& [method, tracer, rate] :
       {std::tuple{"sah", "scalar", 2e6}, {"insertion", "scalar", 3e6}, {"insertion", "embree", 4e6}}) {
    CellResult traced = test_result("sibenik-ogre", method, 0, {});
    traced.tracer = tracer;
    traced.workload = "primary";
    traced.values["trace_rate"] = {ValueClass::absolute, "rays/s", {rate, rate, rate}};
    results.push_back(traced);
  }
  const ReportTable built = build();
  ASSERT_TRUE(cell(built, 0, 0).ours);
  EXPECT_NEAR(cell(built, 0, 0).ours->value, 2e6, 1e-3);
  EXPECT_FALSE(cell(built, 1, 0).ours);
}

TEST_F(TableTest, ATracedValueIsFoundByTracerAndWorkload) {
  Plan traced = plan;
  ColumnSpec& column = traced.tables.front().columns.front();
  traced.tables.front().columns.resize(1);
  column.metric = "trace_rate";
  column.published.clear();
  column.methods = {"insertion"};
  column.tracer = "scalar";
  column.workload = "primary";
  column.relative_to = {"embree"};
  traced.pipelines[1].tracers = {"scalar"};
  CellResult own = test_result("sibenik-ogre", "insertion", 0, {});
  own.tracer = "scalar";
  own.workload = "primary";
  own.values["trace_rate"] = {ValueClass::absolute, "rays/s", {2e6, 2e6, 2e6}};
  CellResult base = own;
  base.method = "embree";
  base.tracer = "embree-single";
  base.values["trace_rate"].samples = {4e6, 4e6, 4e6};
  results.insert(results.end(), {own, base});
  const ReportTable table = build_tables(traced, ResultSet(results), nullptr).front();
  EXPECT_EQ(cell(table, 0, 0).ours->value, 0.5);
  EXPECT_EQ(cell(table, 3, 0).reason, "atrium, insertion: timed out after 60 s") << "the failed build takes its rays with it";
  EXPECT_EQ(cell(table, 1, 0).absence, "not run");
  traced.pipelines[1].tracers = {"simd"};
  const ReportTable without = build_tables(traced, ResultSet(results), nullptr).front();
  EXPECT_EQ(cell(without, 0, 0).absence, "none") << "the study does not trace this method with this tracer";
  EXPECT_EQ(cell(without, 0, 0).reason, "");
}

TEST_F(TableTest, TheBestOfSeveralMethodsOverTheBestOfOthers) {
  plan.tables.front().columns.resize(1);
  ColumnSpec& column = plan.tables.front().columns.front();
  column.metric = "total_time";
  column.published.clear();
  column.methods = {"sah", "insertion"};
  column.relative_to = {"insertion", "sah"};
  const auto first = [this] { return cell(build(), 0, 0); };
  EXPECT_DOUBLE_EQ(first().ours->value, 1) << "of times the least is the best";
  EXPECT_EQ(first().reason, "sah / sah");
  column.higher_is_better = true;
  EXPECT_EQ(first().reason, "insertion / insertion") << "of rates the greatest is";
  column.relative_to = {"sah"};
  EXPECT_DOUBLE_EQ(first().ours->value, 0.41 / 0.052);
  EXPECT_DOUBLE_EQ(first().ours->interval->low, 0.4 / 0.06);
  EXPECT_DOUBLE_EQ(first().ours->interval->high, 0.45 / 0.05);
  EXPECT_EQ(first().reason, "insertion / sah");
  EXPECT_EQ(cell(build(), 3, 0).reason, "sah / sah; without insertion (failed)");
  EXPECT_EQ(cell(build(), 1, 0).absence, "not run");
  column.relative_to.clear();
  column.unit = "s";
  EXPECT_EQ(first().ours->value, 0.41);
  EXPECT_EQ(first().reason, "insertion");
}

TEST_F(TableTest, ATargetIsReachedOrMissedByTheMedian) {
  plan.tables.front().columns.resize(1);
  ColumnSpec& column = plan.tables.front().columns.front();
  column.metric = "total_time";
  column.published.clear();
  column.methods = {"insertion"};
  column.relative_to = {"sah"};
  const auto judged = [&](const char* target) {
    column.targets = {{"sibenik-ogre", *parse_target(target)}};
    return cell(build(), 0, 0);
  };
  EXPECT_EQ(judged(">= 4").verdict, Verdict::reached);
  EXPECT_EQ(judged(">= 4").reason, "");
  EXPECT_EQ(judged("<= 4").verdict, Verdict::missed);
  EXPECT_EQ(judged(">= 7.5").verdict, Verdict::reached);
  EXPECT_EQ(judged(">= 7.5").reason, "the interval reaches across the target");
  EXPECT_EQ(judged(">= 8").verdict, Verdict::missed);
  EXPECT_EQ(judged(">= 8").reason, "the interval reaches across the target");
  EXPECT_EQ(cell(build(), 2, 0).verdict, Verdict::none) << "no target for this scene";
  column.targets = {{"atrium", *parse_target("> 1")}};
  EXPECT_EQ(cell(build(), 3, 0).verdict, Verdict::none) << "no value";
  EXPECT_EQ(cell(build(), 3, 0).target->text(), "> 1");
}

TEST_F(TableTest, OneNumberOfASeriesOverTime) {
  plan.tables.front().columns.resize(1);
  ColumnSpec& column = plan.tables.front().columns.front();
  column.metric = "cost_over_time";
  column.published.clear();
  column.methods = {"insertion"};
  result("sibenik-ogre", "insertion").series["cost_over_time"] = {"seconds", "s", "1", {0, 0.1, 0.2, 0.3}, {80, 75, 72, 71}};
  result("sibenik-ogre", "sah").series["cost_over_time"] = {"seconds", "s", "1", {0, 0.5, 1}, {80, 73, 72.5}};
  const auto at = [&](double seconds) {
    column.at = {{"sibenik-ogre", seconds}};
    return cell(build(), 0, 0).ours->value;
  };
  EXPECT_EQ(at(0), 80);
  EXPECT_EQ(at(0.1), 75);
  EXPECT_EQ(at(0.25), 72);
  EXPECT_EQ(at(9), 71);
  EXPECT_EQ(cell(build(), 0, 0).value_class, ValueClass::absolute);
  EXPECT_EQ(cell(build(), 2, 0).absence, "none") << "asked for one scene only";
  column.at = {{"conference", 1}};
  EXPECT_EQ(cell(build(), 2, 0).reason, "this method has no 'cost_over_time'");
  column.at.clear();
  column.until = "sah";
  column.unit = "ms";
  EXPECT_EQ(cell(build(), 0, 0).ours->value, 200);
  column.relative_to = {"sah"};
  column.unit = "";
  EXPECT_EQ(cell(build(), 0, 0).ours->value, 0.2);
  EXPECT_EQ(cell(build(), 0, 0).value_class, ValueClass::ratio);
  column.relative_to.clear();
  column.methods = {"sah"};
  column.until = "insertion";
  EXPECT_EQ(cell(build(), 0, 0).absence, "not reached");
  EXPECT_EQ(cell(build(), 0, 0).reason, "the 71 that insertion ends with; sah ends with 72.5");
  column.methods = {"insertion"};
  column.until = "sah";
  result("sibenik-ogre", "sah").series["cost_over_time"].y = {80, 81, 80};
  EXPECT_EQ(cell(build(), 0, 0).absence, "none");
  EXPECT_EQ(cell(build(), 0, 0).reason, "sah ends no lower than it begins, with 80");
  result("sibenik-ogre", "sah").series.clear();
  EXPECT_EQ(cell(build(), 0, 0).reason, "sah has no 'cost_over_time' to come down to");
}

TEST_F(TableTest, AFormulaIsOverTheColumnsBeforeIt) {
  ColumnSpec& column = plan.tables.front().columns[3];
  column.metric.clear();
  column.relative_to.clear();
  column.published.clear();
  column.formula = "time / time + cost";
  const ReportTable table = build();
  EXPECT_EQ(cell(table, 0, 3).ours->value, 83.21);
  EXPECT_EQ(cell(table, 0, 3).ours->interval, (Estimate::Interval{83.21, 83.21})) << "a value is drawn once, wherever it is used";
  EXPECT_EQ(cell(table, 0, 3).value_class, ValueClass::ratio);
  EXPECT_EQ(cell(table, 1, 3).absence, "not run");
  column.unit = "s";
  EXPECT_EQ(cell(build(), 0, 3).value_class, ValueClass::absolute);
  column.formula = "relative_cost - cost";
  EXPECT_EQ(cell(build(), 0, 3).value_class, ValueClass::exact);
  EXPECT_EQ(cell(build(), 3, 3).reason, "atrium, insertion: timed out after 60 s");
  column.formula = "1 / (cost - cost)";
  EXPECT_EQ(cell(build(), 0, 3).reason, "'1 / (cost - cost)' divides by 0");
  column.formula = "later";
  EXPECT_EQ(error_of(plan, &*published),
            "test.yaml:13:7: formula of column 'relative_time' names 'later'; expected the name of a column before it");
}

TEST_F(TableTest, TablesOfMethodsComeOncePerScene) {
  plan.tables.front().rows = "method";
  plan.tables.front().columns.resize(1);
  plan.tables.front().columns.front().published.clear();
  plan.tables.front().columns.front().methods.clear();
  const std::vector<ReportTable> tables = build_tables(plan, ResultSet(results), nullptr);
  ASSERT_EQ(tables.size(), 4U);
  EXPECT_EQ(tables[2].name, "table1/conference");
  EXPECT_EQ(tables[2].rows.at(1).label, "insertion");
  EXPECT_EQ(tables[2].rows.at(1).cells.at(0).ours->value, 110.25);
}

TEST_F(TableTest, WrongPublishedKeysAndUnitsAreAllReported) {
  plan.tables.front().columns[0].published = "table1.csot";
  plan.tables.front().columns[2].unit = "ms";
  plan.tables.front().columns[3].published = "claims.value";
  const std::string error = error_of(plan, &*published);
  EXPECT_THAT(error, testing::StartsWith("test.yaml:10:7: there is no published value 'table1.csot' in "));
  EXPECT_THAT(error,
              testing::HasSubstr("; did you mean 'table1.cost'?\n"
                                 "test.yaml:12:7: column 'time' is shown in 'ms'; expected 's', the unit of the published "
                                 "'table1.time'\n"
                                 "test.yaml:13:7: published value 'claims.value' is not given by scene; expected one whose "
                                 "rows are scenes"));
  plan.tables.front().columns.resize(1);
  EXPECT_EQ(error_of(plan, nullptr),
            "test.yaml:10:7: column 'cost' has a published value, but the experiment names no paper; expected 'paper: NAME' for "
            "results/published/NAME.yaml");
}

TEST_F(TableTest, AUnitOfAnotherKindIsAnError) {
  plan.tables.front().columns[0].published.clear();
  plan.tables.front().columns[0].unit = "s";
  EXPECT_EQ(error_of(plan, &*published),
            "test.yaml:10:7: column 'cost' is shown in 's', but its value is a pure number; expected a unit of the same kind");
}

TEST_F(TableTest, APaperWithoutAFileIsAnError) {
  plan.paper = "insertoin";
  plan.file = "/x/experiments/test.yaml";
  try {
    (void)published_of(plan);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "/x/experiments/test.yaml: there are no published values of the paper 'insertoin'; expected the file "
                 "/x/results/published/insertoin.yaml");
  }
  plan.paper.clear();
  EXPECT_FALSE(published_of(plan));
}

}  // namespace
}  // namespace raystudy
