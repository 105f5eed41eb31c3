#include "harness/report/published.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace raystudy {
namespace {

std::string error_of(const std::string& yaml) {
  try {
    (void)parse_published(yaml, "p.yaml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Published, ReadsTheLecture) {
  const Published lecture = read_published(RAYSTUDY_SOURCE_DIR "/results/published/insertion-bittner.yaml");
  const PublishedColumn& cost = lecture.column("table1.cost", {});
  EXPECT_EQ(cost.values.size(), 9U);
  EXPECT_EQ(cost.values.at("Sibenik Cathedral").value, 82.30);
  EXPECT_EQ(cost.values.at("Sibenik Cathedral").text, "82.30");
  EXPECT_EQ(cost.source, "Table 1, p. 17");
  EXPECT_EQ(cost.value_class, ValueClass::exact);
  EXPECT_EQ(lecture.column("table1.time", {}).compared_by, ComparedBy::nothing);
  EXPECT_EQ(lecture.column("table1.relative_time", {}).compared_by, ComparedBy::trend);
  ASSERT_EQ(lecture.scenes.size(), 9U);
  EXPECT_EQ(lecture.scenes.front().name, "Conference");
  EXPECT_EQ(lecture.scenes.back().name, "Pompeii Ten");
  EXPECT_EQ(lecture.scene_of("sibenik-ogre")->comparability, Comparability::same);
  EXPECT_EQ(lecture.scene_of("conference")->comparability, Comparability::variant);
  EXPECT_EQ(lecture.scene_of("atrium"), nullptr);
  EXPECT_EQ(lecture.scene_of(""), nullptr);
}

// The averages that the lecture states of its own Table 1: by 4 % to 24 %, on average 17 %.
TEST(Published, Table1AgreesWithTheLecturesOwnSummary) {
  const Published lecture = read_published(RAYSTUDY_SOURCE_DIR "/results/published/insertion-bittner.yaml");
  double sum = 0;
  for (const auto& [scene, value] : lecture.column("table1.relative_cost", {}).values) sum += 100 - value.value;
  EXPECT_NEAR(sum / 9, 17, 2);
}

TEST(Published, NamesTheNearestKey) {
  const Published lecture = read_published(RAYSTUDY_SOURCE_DIR "/results/published/insertion-bittner.yaml");
  try {
    (void)lecture.column("table1.csot", {"x.yaml", 4, 9});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::StartsWith("x.yaml:4:9: there is no published value 'table1.csot' in "));
    EXPECT_THAT(error.what(), testing::HasSubstr("insertion-bittner.yaml; expected one of table1.cost, table1.relative_cost, "));
    EXPECT_THAT(error.what(), testing::EndsWith("; did you mean 'table1.cost'?"));
  }
}

TEST(Published, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_of("citation: [a"), "p.yaml:1:1: this is no YAML: end of sequence flow not found");
  EXPECT_EQ(error_of("citation: a\nscenes: {}\n"), "p.yaml:1:1: the file has no 'tables'");
  EXPECT_EQ(error_of("- a"), "p.yaml:1:1: the file is a list; expected the keys citation, scenes, tables");
  EXPECT_EQ(error_of("citation: {}\nscenes: {}\ntables: {}"), "p.yaml:1:11: 'citation' is a map; expected a text");
  EXPECT_EQ(error_of("citation: a\nscenes: a\ntables: []"),
            "p.yaml:2:9: 'scenes' is the text 'a'; expected the paper's scenes by name\n"
            "p.yaml:3:9: 'tables' is a list; expected the paper's tables by name");
  EXPECT_EQ(error_of("citation: a\nscens: {}\nscenes: {}\ntables: {}\nscenes: {}"),
            "p.yaml:2:1: unknown key 'scens' in the file; expected one of citation, scenes, tables; did you mean 'scenes'?\n"
            "p.yaml:5:1: key 'scenes' stands a second time; expected each key once; the first is on line 3");
  EXPECT_EQ(
      error_of(
          "citation: a\nscenes:\n  A: {ours: a, comparability: sme}\n  B: {comparability: variant}\n  C: {ours: a}\ntables: {}"),
      "p.yaml:3:31: 'comparability' is the text 'sme'; expected one of same, close-variant, variant, unverified; did you mean "
      "'same'?\n"
      "p.yaml:4:6: scene 'B' has no 'ours'\n"
      "p.yaml:4:6: scene 'B' has no 'reason'\n"
      "p.yaml:5:6: scenes 'A' and 'C' are both our 'a'");
}

TEST(Published, SaysWhatIsWrongInATable) {
  const std::string head = "citation: a\nscenes: {A: {ours: a}}\ntables:\n  t:\n    source: s\n    columns:\n";
  const std::string column = "      - {name: c, what: w, unit: s, class: exact, tolerance: {relative: 0.01}}\n";
  EXPECT_EQ(error_of(head + column + "    values:\n      A: [1, 2]\n"),
            "p.yaml:9:10: row 'A' of table 't' has 2 values; expected 1, one a column (~ where nothing is published)");
  EXPECT_EQ(error_of(head + column + "    values: [1]\n"), "p.yaml:8:13: 'values' of table 't' is a list; expected rows by name");
  EXPECT_EQ(error_of("citation: a\nscenes: {}\ntables: {t: {source: s, columns: 3, values: {}}}"),
            "p.yaml:3:34: 'columns' of table 't' is the integer 3; expected a list of columns");
  EXPECT_EQ(error_of(head + column + "    values:\n      A: [x]\n"),
            "p.yaml:9:11: 'c' of row 'A' is the text 'x'; expected a number");
  EXPECT_EQ(error_of(head + column + "    values:\n      AB: [1]\n      A: [nan]\n"),
            "p.yaml:9:7: row 'AB' of table 't' is no scene of this file; expected one of A\n"
            "p.yaml:10:11: 'c' of row 'A' is the text 'nan'; expected a number");
  EXPECT_EQ(error_of(head + column + column + "    values: {A: [1, 1]}\n"), "p.yaml:8:9: duplicate column 'c' in table 't'");
  EXPECT_EQ(
      error_of(head + "      - {name: c, what: w, unit: s, class: absolute, tolerance: {relative: 1}}\n    values: {}\n"),
      "p.yaml:7:9: column 'c' is absolute and compared by value; expected 'compare: trend' or 'compare: nothing': an absolute "
      "number belongs to its machine");
  EXPECT_EQ(error_of(head + "      - {name: c, what: w, unit: s, class: exact}\n    values: {}\n"),
            "p.yaml:7:9: column 'c', which is compared by value, has no 'tolerance'");
  EXPECT_EQ(error_of(head + "      - {name: c, what: w, unit: s, class: exact, compare: trend}\n    values: {}\n"),
            "p.yaml:7:9: column 'c', which is not compared by value, has no 'reason'");
  EXPECT_EQ(error_of(head + "      - {name: c, what: w, unit: s, class: exact, tolerance: {relative: -1}}\n    values: {}\n"),
            "p.yaml:7:73: 'relative' is -1; expected a number of at least 0");
  EXPECT_EQ(error_of(head + "      - {name: c, what: w, unit: s, class: exact, tolerance: {}}\n    values: {}\n"),
            "p.yaml:7:62: 'tolerance' needs exactly one of 'relative' and 'absolute'");
}

TEST(Published, SaysThatAFileIsNotThere) {
  try {
    (void)read_published("/nowhere/p.yaml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/nowhere/p.yaml: cannot be read: there is no folder '/nowhere'");
  }
}

TEST(Tolerance, IsAShareOrAnAmount) {
  const Tolerance percent{true, 0.01};
  EXPECT_TRUE(percent.accepts(82.30, 83.12));   // + 0.996 %
  EXPECT_FALSE(percent.accepts(82.30, 83.13));  // + 1.009 %
  EXPECT_EQ(percent.text(""), "1 % of the published value");
  const Tolerance points{false, 0.5};
  EXPECT_TRUE(points.accepts(84.45, 83.95));
  EXPECT_FALSE(points.accepts(84.45, 83.94));
  EXPECT_EQ(points.text("%"), "0.5 points");
  EXPECT_EQ(points.text("s"), "0.5 s");
}

}  // namespace
}  // namespace raystudy
