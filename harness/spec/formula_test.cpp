#include "harness/spec/formula.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "harness/base/error.h"

namespace raystudy {
namespace {

double evaluate(std::string_view text) {
  return Formula(text).evaluate([](std::string_view name) {
    if (name == "two") return 2.0;
    return name == "ten" ? 10.0 : std::nan("");
  });
}

std::string refusal(const std::string& text) {
  try {
    (void)Formula(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Formula, UsualPrecedenceFromLeftToRight) {
  EXPECT_EQ(evaluate("1 + 2 * 3"), 7);
  EXPECT_EQ(evaluate("(1 + 2) * 3"), 9);
  EXPECT_EQ(evaluate("10 - 4 - 3"), 3);
  EXPECT_EQ(evaluate("ten / two / two"), 2.5);
  EXPECT_EQ(evaluate("-two * -3 + .5"), 6.5);
  EXPECT_EQ(evaluate("1 - -1"), 2);
  EXPECT_EQ(evaluate("1e3/ten"), 100);
}

TEST(Formula, MissingValuesAndDivisionByZeroPassThrough) {
  EXPECT_TRUE(std::isnan(evaluate("1 + absent")));
  EXPECT_TRUE(std::isinf(evaluate("1 / (two - 2)")));
}

TEST(Formula, NamesStandOnceInTheirOrder) {
  EXPECT_THAT(Formula("b / a + b").names(), testing::ElementsAre("b", "a"));
  EXPECT_TRUE(is_formula_name("cost_2"));
  EXPECT_FALSE(is_formula_name("2cost"));
  EXPECT_FALSE(is_formula_name("a-b"));
  EXPECT_FALSE(is_formula_name(""));
}

TEST(Formula, SaysWhatStandsWhere) {
  EXPECT_EQ(refusal("1 +"), "formula '1 +': it ends too early; expected a number, a column's name or '('");
  EXPECT_EQ(refusal("(1 + 2"), "formula '(1 + 2': it ends too early; expected ')'");
  EXPECT_EQ(refusal("1 2"), "formula '1 2': '2' stands at letter 3; expected the end, or one of + - * /");
  EXPECT_EQ(refusal("1 + inf("), "formula '1 + inf(': '(' stands at letter 8; expected the end, or one of + - * /");
  EXPECT_EQ(refusal("a % b"), "formula 'a % b': '%' stands at letter 3; expected the end, or one of + - * /");
  EXPECT_EQ(refusal(""), "formula '': it ends too early; expected a number, a column's name or '('");
  EXPECT_NE(refusal(std::string(300, '(')).find("expected at most 200 parentheses inside each other"), std::string::npos);
  std::string sum = "1";
  for (int i = 0; i < 1200; ++i) sum += "+1";
  EXPECT_NE(refusal(sum).find("expected at most 1000 operations"), std::string::npos);
}

}  // namespace
}  // namespace raystudy
