#include "harness/report/slope.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "harness/report/format.h"
#include "harness/report/test_study.h"

namespace raystudy {
namespace {

using testing::ElementsAre;

/// Two sweeps of three sizes; on atrium sah takes 1, 8, 16 s for 1, 4, 16 thousand triangles (slope 1, error √(1/12)), on soup
/// triangles / 1000 s.
class SlopeTest : public testing::Test {
 protected:
  SlopeTest() {
    plan.paper.clear();
    plan.scenes.clear();
    for (const char* base : {"atrium", "soup"}) {
      for (const auto& [triangles, seconds] : {std::pair{1000, 1.0}, {4000, 8.0}, {16000, 16.0}}) {
        SceneSpec scene;
        scene.base = base;
        scene.label = fmt::format("{}[triangles={}]", base, triangles);
        plan.scenes.push_back(scene);
        const double time = base == std::string("atrium") ? seconds : triangles / 1000.0;
        results.push_back(test_result(scene.label, "sah", triangles * 2, {time, time, time}));
        results.back().values["triangles"] = {ValueClass::exact, "1", {static_cast<double>(triangles)}};
      }
    }
    table().rows = "method";
    table().slopes = true;
    table().columns.erase(table().columns.begin() + 3);
    table().columns.erase(table().columns.begin() + 1);
    for (ColumnSpec& column : table().columns) {
      column.published.clear();
      column.methods.clear();
    }
  }
  TableSpec& table() { return plan.tables.front(); }
  [[nodiscard]] std::vector<ReportTable> build() const { return build_tables(plan, ResultSet(results), nullptr); }

  Plan plan = test_plan();
  std::vector<CellResult> results;
};

TEST_F(SlopeTest, ATableForEachSweepOfScenes) {
  const std::vector<ReportTable> tables = build();
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].name, "table1/atrium");
  const ReportCell& time = tables[0].rows.at(0).cells.at(1);
  EXPECT_NEAR(time.ours->value, 1, 1e-12);
  EXPECT_NEAR(time.ours->interval->high - 1, 0.288675, 1e-6);
  EXPECT_EQ(shown_value(time, 2), "1.00 ± 0.29");
  EXPECT_EQ(time.value_class, ValueClass::ratio);
  EXPECT_EQ(tables[0].columns.at(1).unit, "");
  EXPECT_EQ(tables[0].rows.at(0).cells.at(0).value_class, ValueClass::exact) << "a slope of costs";
  EXPECT_EQ(shown_value(tables[1].rows.at(0).cells.at(1), 2), "1.00 ± 0.00");
  EXPECT_EQ(tables[0].rows.at(1).cells.at(1).absence, "not run");
  EXPECT_THAT(tables[0].remarks, testing::Contains(testing::StartsWith("Slopes: ")));
}

TEST_F(SlopeTest, RowsMayBeTheSweeps) {
  table().rows = "scene";
  for (ColumnSpec& column : table().columns) column.methods = {"sah"};
  const std::vector<ReportTable> tables = build();
  ASSERT_EQ(tables.size(), 1U);
  ASSERT_EQ(tables[0].rows.size(), 2U);
  EXPECT_EQ(tables[0].rows[1].label, "soup");
  table().row_filter = {"soup[triangles=1000]", "soup[triangles=4000]", "soup[triangles=16000]"};
  EXPECT_EQ(build()[0].rows.size(), 1U);
}

TEST_F(SlopeTest, WhatIsMissingIsSaid) {
  results[1].values.erase("total_time");
  EXPECT_EQ(shown_value(build()[0].rows[0].cells[1], 2), "1.00") << "two points have no error";
  EXPECT_EQ(build()[0].rows[0].cells[1].reason, "without atrium[triangles=4000] (none)");
  results[2].values.erase("total_time");
  EXPECT_EQ(build()[0].rows[0].cells[1].absence, "none");
  EXPECT_EQ(build()[0].rows[0].cells[1].reason,
            "a slope needs scenes of two sizes; without atrium[triangles=4000] (none), atrium[triangles=16000] (none)");
}

TEST_F(SlopeTest, TimesOfTwoMachinesHaveNone) {
  results[1].provenance["cpu"] = "A slow one";
  EXPECT_EQ(build()[0].rows[0].cells[1].reason, "times of different machines have no slope: cpu: A fast one and A slow one");
  EXPECT_TRUE(build()[0].rows[0].cells[0].ours) << "exact values have";
}

TEST_F(SlopeTest, Bases) {
  EXPECT_THAT(scene_bases(plan, {}), ElementsAre("atrium", "soup"));
  EXPECT_THAT(scene_bases(plan, {"soup[triangles=4000]"}), ElementsAre("soup"));
  EXPECT_EQ(scenes_of(plan, "soup").size(), 3U);
}

}  // namespace
}  // namespace raystudy
