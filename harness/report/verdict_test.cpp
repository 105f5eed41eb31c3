#include "harness/report/verdict.h"

#include <gtest/gtest.h>

namespace raystudy {
namespace {

PublishedColumn cost() {
  PublishedColumn column;
  column.tolerance = {true, 0.01};
  return column;
}

PublishedColumn relative_cost() {
  PublishedColumn column;
  column.unit = "%";
  column.tolerance = {false, 0.5};
  column.baseline = 100;
  return column;
}

PublishedColumn relative_time() {
  PublishedColumn column;
  column.unit = "%";
  column.compared_by = ComparedBy::trend;
  column.reason = "hardware";
  column.baseline = 100;
  return column;
}

const PublishedScene same{"S", "s", Comparability::same, ""};
const PublishedScene close_variant{"S", "s", Comparability::close_variant, "two triangles more"};
const PublishedScene variant{"S", "s", Comparability::variant, "twice the triangles"};

std::string text(const Judgement& j) {
  return std::string(verdict_name(j.verdict)) + (j.reason.empty() ? "" : " (" + j.reason + ")");
}
std::string verdict(const PublishedColumn& column, const PublishedScene* scene, double published, const Estimate& ours,
                    const std::vector<Peer>& peers = {}) {
  return text(judge(column, scene, published, ours, peers));
}

TEST(Verdict, MatchesWithinTheTolerance) {
  EXPECT_EQ(verdict(cost(), &same, 82.30, {82.21, {}}), "match");
  EXPECT_EQ(verdict(relative_cost(), &same, 84.45, {84.95, {}}), "match");
  EXPECT_EQ(verdict(cost(), nullptr, 100, {101, {}}), "match");
}

TEST(Verdict, OutsideTheToleranceTheSignOfTheChangeDecides) {
  EXPECT_EQ(verdict(relative_cost(), &same, 84.45, {82, {}}), "trend (outside the tolerance of 0.5 points)");
  EXPECT_EQ(verdict(relative_cost(), &same, 84.45, {101, {}}),
            "differs (outside the tolerance of 0.5 points; the order of the methods or the sign of the change is another)");
  EXPECT_EQ(verdict(cost(), &same, 82.30, {99, {}}),
            "differs (outside the tolerance of 1 % of the published value; no other method's value to compare the order with)");
}

TEST(Verdict, TheOrderOfEveryPairOfMethodsCounts) {
  const std::vector<Peer> kept{{90, {95, {}}}, {70, {60, {}}}};
  EXPECT_EQ(verdict(cost(), &same, 80, {85, {}}, kept), "trend (outside the tolerance of 1 % of the published value)");
  const std::vector<Peer> turned{{90, {95, {}}}, {70, {86, {}}}};
  EXPECT_EQ(verdict(cost(), &same, 80, {85, {}}, turned),
            "differs (outside the tolerance of 1 % of the published value; the order of the methods or the sign of the change is "
            "another)");
  // A peer that is published equal says nothing of the order.
  EXPECT_EQ(verdict(cost(), &same, 80, {85, {}}, {{80, {1, {}}}}),
            "differs (outside the tolerance of 1 % of the published value; no other method's value to compare the order with)");
}

TEST(Verdict, AnOrderThatNoiseCouldTurnIsNotShown) {
  const PublishedColumn column = relative_time();
  EXPECT_EQ(verdict(column, &same, 209.09, {150, Estimate::Interval{120, 180}}),
            "trend (only the direction is compared: hardware)");
  EXPECT_EQ(verdict(column, &same, 209.09, {150, Estimate::Interval{90, 180}}),
            "differs (only the direction is compared: hardware; the noise leaves the order or the sign of the change open)");
  EXPECT_EQ(verdict(column, &same, 209.09, {95, Estimate::Interval{90, 99}}),
            "differs (only the direction is compared: hardware; the order of the methods or the sign of the change is another)");
}

TEST(Verdict, ACloseVariantIsComparedAndSaysSo) {
  EXPECT_EQ(verdict(cost(), &close_variant, 220.2, {220, {}}), "match (close variant of the scene: two triangles more)");
  EXPECT_EQ(
      verdict(cost(), &close_variant, 220.2, {212.5, {}}),
      "differs (outside the tolerance of 1 % of the published value; close variant of the scene: two triangles more; no other "
      "method's value to compare the order with)");
  EXPECT_EQ(verdict(relative_cost(), &close_variant, 82.74, {84, {}}),
            "trend (outside the tolerance of 0.5 points; close variant of the scene: two triangles more)");
}

TEST(Verdict, OfAVariantOnlyTheDirectionOfRelativeValuesIsCompared) {
  EXPECT_EQ(verdict(cost(), &variant, 130.3, {130.3, {}}), "not comparable (scene variant: twice the triangles)");
  EXPECT_EQ(verdict(relative_cost(), &variant, 78.66, {78.66, {}}),
            "trend (only the direction is compared: scene variant: twice the triangles)");
  EXPECT_EQ(
      verdict(relative_cost(), &variant, 78.66, {100.5, {}}),
      "differs (only the direction is compared: scene variant: twice the triangles; the order of the methods or the sign of the "
      "change is another)");
}

TEST(Verdict, OtherHardwareIsNotComparable) {
  PublishedColumn time;
  time.compared_by = ComparedBy::nothing;
  time.reason = "hardware: a Xeon";
  EXPECT_EQ(verdict(time, &same, 0.66, {0.66, {}}), "not comparable (hardware: a Xeon)");
  PublishedColumn trend = time;
  trend.compared_by = ComparedBy::trend;
  EXPECT_EQ(
      verdict(trend, &same, 0.66, {0.66, {}}),
      "not comparable (only the direction is compared: hardware: a Xeon; no other method's value to compare the order with)");
}

}  // namespace
}  // namespace raystudy
