#include "harness/base/error.h"

#include <gtest/gtest.h>

namespace raystudy {
namespace {

TEST(Error, SaysWhereWhatExpectedAndNearest) {
  const Error error(Diagnostic{{"a.yaml", 3, 5}, "unknown method 'sweep-shah'", "a builder", "sweep-sah"});
  EXPECT_STREQ(error.what(), "a.yaml:3:5: unknown method 'sweep-shah'; expected a builder; did you mean 'sweep-sah'?");
}

TEST(Error, ShowsAllDiagnosticsOneALine) {
  const Error error({{{"a.yaml", 1, 0}, "one", {}, {}}, {{"a.yaml", 2, 0}, "two", {}, {}}});
  EXPECT_STREQ(error.what(), "a.yaml:1: one\na.yaml:2: two");
}

TEST(NearestName, FindsTranspositionsAndRefusesStrangers) {
  EXPECT_EQ(nearest_name("isnertion", {"insertion", "embree"}), "insertion");
  EXPECT_EQ(nearest_name("xyzzy", {"insertion", "embree"}), "");
  EXPECT_EQ(nearest_name("", {"insertion"}), "");
}

}  // namespace
}  // namespace raystudy
