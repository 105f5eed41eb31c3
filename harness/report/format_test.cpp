#include "harness/report/format.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "harness/report/test_study.h"

namespace raystudy {
namespace {

std::string read_file(const std::string& name) {
  std::ifstream stream(name, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Compares with harness/report/testdata/NAME; RAYSTUDY_UPDATE_GOLDEN=1 writes that file instead, to be looked at and committed.
void expect_golden(const std::string& name, const std::string& found) {
  const std::string file = std::string(RAYSTUDY_SOURCE_DIR "/harness/report/testdata/") + name;
  if (std::getenv("RAYSTUDY_UPDATE_GOLDEN") != nullptr) std::ofstream(file, std::ios::binary) << found;
  EXPECT_EQ(found, read_file(file));
}

std::string formatted(TableFormat format, const Plan& plan, const Published* published) {
  std::ostringstream out;
  write_tables(build_tables(plan, ResultSet(test_results()), published), format, out);
  return out.str();
}

class FormatTest : public testing::Test {
 protected:
  Plan plan = test_plan();
  std::optional<Published> published = published_of(plan);
};

TEST_F(FormatTest, Markdown) { expect_golden("table1.md", formatted(TableFormat::markdown, plan, &*published)); }
TEST_F(FormatTest, Latex) { expect_golden("table1.tex", formatted(TableFormat::latex, plan, &*published)); }
TEST_F(FormatTest, Csv) { expect_golden("table1.csv", formatted(TableFormat::csv, plan, &*published)); }
TEST_F(FormatTest, CsvWide) { expect_golden("table1-wide.csv", formatted(TableFormat::csv_wide, plan, &*published)); }

/// The same study with methods as rows and nothing published.
Plan by_method() {
  Plan plan = test_plan();
  plan.paper.clear();
  plan.scenes.resize(1);
  TableSpec& table = plan.tables.front();
  table.name = "methods";
  table.rows = "method";
  table.columns.erase(table.columns.begin() + 1);
  table.columns.pop_back();
  for (ColumnSpec& c : table.columns) {
    c.methods.clear();
    c.published.clear();
  }
  table.columns.back().unit = "ms";
  table.columns.back().label = "time | all";
  return plan;
}

TEST(Format, MarkdownByMethod) { expect_golden("methods.md", formatted(TableFormat::markdown, by_method(), nullptr)); }
TEST(Format, LatexByMethod) { expect_golden("methods.tex", formatted(TableFormat::latex, by_method(), nullptr)); }

/// Targets as rows, scenes side by side.
Plan targets() {
  Plan plan = test_plan();
  plan.paper.clear();
  plan.scenes.erase(plan.scenes.begin() + 1);
  TableSpec& table = plan.tables.front();
  table.name = "targets";
  table.transposed = true;
  table.columns.erase(table.columns.begin() + 1);
  table.columns.back().label = "time of the best";
  table.columns.back().methods = {"sah", "insertion"};
  table.columns.back().unit = "";
  for (ColumnSpec& c : table.columns) c.published.clear();
  for (const SceneSpec& scene : plan.scenes) table.columns.back().targets[scene.label] = *parse_target("<= 1.0");
  table.columns.front().targets["conference"] = *parse_target("< 140.5");
  return plan;
}

TEST(Format, MarkdownOfTargets) { expect_golden("targets.md", formatted(TableFormat::markdown, targets(), nullptr)); }
TEST(Format, LatexOfTargets) { expect_golden("targets.tex", formatted(TableFormat::latex, targets(), nullptr)); }
TEST(Format, CsvOfTargets) { expect_golden("targets.csv", formatted(TableFormat::csv, targets(), nullptr)); }
TEST(Format, CsvWideOfTargets) { expect_golden("targets-wide.csv", formatted(TableFormat::csv_wide, targets(), nullptr)); }

TEST(Format, CsvQuotesWhatNeedsIt) {
  ReportTable table;
  table.name = "a,b";
  table.columns.push_back({"c\"d", "", "s", 2, nullptr});
  ReportCell cell;
  cell.absence = "failed";
  cell.reason = "two\nlines";
  table.rows.push_back({"r", {cell}});
  std::ostringstream out;
  write_csv({table}, out);
  EXPECT_EQ(out.str(),
            "table,row,column,class,unit,published,target,ours,low,high,ratio,verdict,reason\r\n"
            "\"a,b\",r,\"c\"\"d\",,s,,,,,,,,\"two\nlines\"\r\n");
}

TEST(TableFormat, NamesTheNearest) {
  EXPECT_EQ(table_format("csv-wide"), TableFormat::csv_wide);
  try {
    (void)table_format("markdwon");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "there is no table format 'markdwon'; expected one of markdown, latex, csv, csv-wide; did you mean 'markdown'?");
  }
}

}  // namespace
}  // namespace raystudy
