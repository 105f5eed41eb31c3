#include "harness/report/break_even.h"

#include <gtest/gtest.h>

#include <limits>

#include "harness/report/test_study.h"

namespace raystudy {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FastestRanges, TheLowerEnvelopeOfTheLines) {
  // 1 + 4 n, 3 + 2 n and 6 + n meet at 1 and 3; 5 + 2 n is always above the second, 4.6 + 1.5 n at 3 above both.
  const std::vector<TotalTime> times{{6, 1}, {1, 4}, {5, 2}, {3, 2}, {4.6, 1.5}};
  const auto ranges = fastest_ranges(times);
  ASSERT_EQ(ranges.size(), 5U);
  EXPECT_EQ(ranges[1]->first, 0);
  EXPECT_EQ(ranges[1]->last, 1);
  EXPECT_EQ(ranges[3]->first, 1);
  EXPECT_EQ(ranges[3]->last, 3);
  EXPECT_EQ(ranges[0]->first, 3);
  EXPECT_EQ(ranges[0]->last, infinity);
  EXPECT_FALSE(ranges[2]);
  EXPECT_FALSE(ranges[4]);
}

TEST(FastestRanges, OfEqualsTheFirst) {
  const std::vector<TotalTime> same{{1, 1}, {1, 1}};
  EXPECT_TRUE(fastest_ranges(same)[0]);
  EXPECT_FALSE(fastest_ranges(same)[1]);
  const std::vector<TotalTime> same_build{{1, 2}, {1, 1}};
  EXPECT_FALSE(fastest_ranges(same_build)[0]) << "never alone the fastest";
  EXPECT_EQ(fastest_ranges(same_build)[1]->first, 0);
  // All three meet at 1: the middle one is never alone the fastest.
  const std::vector<TotalTime> meeting{{1, 3}, {2, 2}, {3, 1}};
  EXPECT_EQ(fastest_ranges(meeting)[0]->last, 1);
  EXPECT_FALSE(fastest_ranges(meeting)[1]);
  EXPECT_EQ(fastest_ranges(meeting)[2]->first, 1);
}

TEST(FastestRanges, OfOneAndOfNone) {
  const std::vector<TotalTime> one{{1, 1}};
  EXPECT_EQ(fastest_ranges(one)[0]->first, 0);
  EXPECT_EQ(fastest_ranges(one)[0]->last, infinity);
  EXPECT_TRUE(fastest_ranges({}).empty());
}

class BreakEvenTest : public testing::Test {
 protected:
  void add(const std::string& method, double build, double rate) {
    results.push_back(test_result("atrium", method, 1, {build, build, build}));
    CellResult traced = test_result("atrium", method, 1, {});
    traced.tracer = method + "'s";
    traced.workload = "random";
    traced.values = {{"trace_rate", {ValueClass::absolute, "rays/s", {rate, rate, rate}}}};
    results.push_back(traced);
    places.push_back({"atrium", method, own_tracer, "random"});
  }
  std::vector<CellResult> results;
  std::vector<ValuePlace> places;
};

TEST_F(BreakEvenTest, RangesOfRaysOfTheMethods) {
  add("fast to trace", 3, 1e6);
  add("fast to build", 1, 0.5e6);
  add("slow", 5, 0.4e6);
  const std::vector<ReportCell> cells = break_even_cells(places, ResultSet(results));
  EXPECT_NEAR(cells[0].ours->value, 2e6, 1e-3);
  EXPECT_EQ(cells[0].range_end, infinity);
  EXPECT_EQ(cells[1].ours->value, 0);
  EXPECT_NEAR(*cells[1].range_end, 2e6, 1e-3);
  EXPECT_FALSE(cells[2].ours);
  EXPECT_EQ(cells[2].absence, "never");
}

TEST_F(BreakEvenTest, AMethodWithoutTimesTakesNoPart) {
  add("good", 1, 1e6);
  add("failed", 0.5, 2e6);
  results.back().status = CellStatus::failed;
  results.back().reason = "crashed";
  places.push_back({"atrium", "absent", own_tracer, "random"});
  const std::vector<ReportCell> cells = break_even_cells(places, ResultSet(results));
  EXPECT_EQ(cells[0].range_end, infinity);
  EXPECT_EQ(cells[1].absence, "failed");
  EXPECT_EQ(cells[1].reason, "atrium, failed, own, random: crashed");
  EXPECT_EQ(cells[2].absence, "not run");
}

TEST_F(BreakEvenTest, TimesOfAnotherMachineTakeNoPart) {
  add("here", 1, 1e6);
  add("there", 0.5, 2e6);
  results.back().provenance["cpu"] = "A slow one";
  const std::vector<ReportCell> cells = break_even_cells(places, ResultSet(results));
  EXPECT_TRUE(cells[0].ours);
  EXPECT_EQ(cells[1].absence, "none");
  EXPECT_EQ(cells[1].reason, "times of different machines are not added: cpu: A fast one and A slow one");
}

}  // namespace
}  // namespace raystudy
