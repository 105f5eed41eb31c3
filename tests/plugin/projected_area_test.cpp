#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "harness/base/error.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(RAYSTUDY_SOURCE_DIR) + "/" + path);
  EXPECT_TRUE(file) << path;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(ProjectedArea, MeasuresTheFaceThatTheRaysSee) {
  const Registry& registry = Registry::instance();
  const auto measure = registry.create<Heuristic>(registry.ref(Role::heuristic, "projected-area"))->prepare({}, {});
  const Box box{{0, 0, 0}, {2, 5, 3}};
  float value = 0;
  measure->evaluate({&box, 1}, {&value, 1});
  EXPECT_EQ(value, 6);  // rays go down: only the 2 x 3 face counts
}

TEST(ProjectedArea, RefusesTheZeroDirection) {
  const Registry& registry = Registry::instance();
  const MethodRef zero = registry.ref(Role::heuristic, "projected-area", {{"y", 0.0}});
  EXPECT_THROW((void)registry.create<Heuristic>(zero), Error);
}

TEST(Contributing, ShowsTheVeryFilesThatAreTested) {
  EXPECT_THAT(text_of("CONTRIBUTING.md"), testing::HasSubstr(text_of("tests/plugin/projected_area.cpp")));
  EXPECT_THAT(text_of("CONTRIBUTING.md"), testing::HasSubstr(text_of("tests/plugin/my-study.yaml")));
}

}  // namespace
}  // namespace raystudy
