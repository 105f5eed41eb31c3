#include "harness/spec/target.h"

#include <gtest/gtest.h>

namespace raystudy {
namespace {

TEST(Target, ABoundAndItsSide) {
  const auto met = [](const char* text, double value) { return parse_target(text).value().is_met_by(value); };
  EXPECT_TRUE(met(">= 1.15", 1.15));
  EXPECT_FALSE(met(">= 1.15", 1.1499));
  EXPECT_FALSE(met("> 1.15", 1.15));
  EXPECT_TRUE(met("<= 1", 1));
  EXPECT_FALSE(met("<1", 1));
  EXPECT_TRUE(met("<1", 0.5));
  EXPECT_FALSE(met("< -2", -1));
}

TEST(Target, IsShownAsWritten) {
  EXPECT_EQ(parse_target(">=1.10").value().text(), "≥ 1.10");
  EXPECT_EQ(parse_target("<= 77.3").value().text(), "≤ 77.3");
  EXPECT_EQ(parse_target("> 0").value().text(), "> 0");
  EXPECT_EQ(parse_target("<   4").value().text(), "< 4");
}

TEST(Target, NothingElseIsOne) {
  for (const char* text : {"", "1.15", ">", ">=", "=> 1", ">= x", ">= 1 s", "== 1", ">= 1 2", "< inf"}) {
    EXPECT_FALSE(parse_target(text)) << text;
  }
}

}  // namespace
}  // namespace raystudy
