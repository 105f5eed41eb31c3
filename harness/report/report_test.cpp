#include "harness/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "harness/report/test_study.h"
#include "harness/run/run.h"
#include "harness/spec/cell_id.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

class ReportTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / "report_test" / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(results_folder(plan, folder));
    for (std::size_t p = 0; p < 2; ++p) {
      plan.pipelines[p].builder = {"sweep-sah", nullptr};
      Cell cell;
      cell.scene = 0;
      cell.pipeline = p;
      plan.cells.push_back(cell);
    }
    plan.scenes.resize(1);
    plan.scenes.front().name = plan.scenes.front().label = "atrium";
    plan.scenes.front().triangles = 1000;
  }
  void write(std::size_t cell, double cost) {
    CellResult result = test_result("atrium", plan.pipelines[cell].label, cost, {1, 1, 1});
    result.id = cell_id(plan, plan.cells[cell]);
    write_result(results_folder(plan, folder), result);
  }

  Plan plan = test_plan();
  fs::path folder;
};

TEST_F(ReportTest, SaysWhichCellsHaveNoResult) {
  write(0, 50);
  const Report report(plan, folder);
  EXPECT_EQ(report.tables().front().rows.front().cells[0].ours->value, 50);
  EXPECT_EQ(report.tables().front().rows.front().cells[1].absence, "not run");
  EXPECT_THAT(report.gaps(), testing::ElementsAre("1 of 2 cells have no result yet: raystudy run " + plan.file));
}

TEST_F(ReportTest, NeverShowsAResultOfOtherSettings) {
  write(0, 50);
  write(1, 40);
  EXPECT_THAT(Report(plan, folder).gaps(), testing::IsEmpty());
  plan.seed = 2;
  write(1, 41);
  const Report report(plan, folder);
  EXPECT_EQ(report.tables().front().rows.front().cells[0].absence, "not run");
  EXPECT_THAT(report.gaps(),
              testing::ElementsAre("1 of 2 cells have no result yet: raystudy run " + plan.file,
                                   "2 results in the folder are of other code, scale or settings and are not shown"));
}

TEST_F(ReportTest, PrintsTablesAndGaps) {
  CellResult failed = test_result("atrium", "sah", 0, {});
  failed.status = CellStatus::failed;
  failed.reason = "crashed: SIGSEGV while building";
  std::ostringstream out;
  print_tables(Report(plan, std::vector<CellResult>{failed}), out);
  EXPECT_THAT(out.str(), testing::StartsWith("### table1: Costs & times, 100 % of them\n"));
  EXPECT_THAT(out.str(), testing::HasSubstr("(1) atrium, sah: crashed: SIGSEGV while building  \n"));
  EXPECT_THAT(out.str(), testing::EndsWith("\n\n1 of 2 cells have no result yet: raystudy run " + plan.file +
                                           "\nfailed: atrium/sah: crashed: SIGSEGV while building\n"));
}

TEST_F(ReportTest, ChoosesATableByName) {
  plan.tables.push_back(plan.tables.front());
  plan.tables.back().name = "table2";
  const Report report(plan, folder);
  EXPECT_EQ(report.tables().size(), 2U);
  EXPECT_EQ(report.tables("table2").front().name, "table2");
  try {
    (void)report.tables("tabel1");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), plan.file + ": there is no table 'tabel1'; expected one of table1, table2; did you mean 'table1'?");
  }
  plan.tables.clear();
  try {
    (void)Report(plan, folder).tables("table1");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), plan.file + ": there is no table 'table1'; expected an experiment with tables");
  }
}

TEST_F(ReportTest, ACorruptResultIsAnError) {
  const fs::path file = result_file(results_folder(plan, folder), cell_id(plan, plan.cells[0]));
  std::ofstream(file) << "{\"format\": 1,";
  try {
    const Report report(plan, folder);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith(file.string() + ":1:"));
  }
}

}  // namespace
}  // namespace raystudy
