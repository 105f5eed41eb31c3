#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/method/registry.h"
#include "harness/spec/cells.h"
#include "harness/spec/plan.h"

namespace raystudy {
namespace {

using testing::ElementsAre;

TEST(ReadPlan, EmptyFile) {
  try {
    (void)parse_plan("", "x.yaml", Scale::quick);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "x.yaml: the file is empty; expected an experiment: a map with 'scenes' and 'methods'");
  }
}

}  // namespace
}  // namespace raystudy
