#include "harness/method/registry.h"

#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace raystudy {
namespace {

class NullHeuristic : public Heuristic {
 public:
  explicit NullHeuristic(const Params& params) : scale(params.real("scale")) {}
  static MethodInfo info() {
    return {.name = "null",
            .summary = "measures nothing",
            .citation = "none",
            .params = {real_param("scale", 1.5, "factor", 0, 10), integer_param("bins", 16, "number of bins", 2, 256),
                       choice_param("centres", {"box", "centroid"}, "what orders triangles")}};
  }
  [[nodiscard]] std::shared_ptr<const Measure> prepare(const Scene&, const BuildContext&) const override {
    return surface_area();
  }
  double scale;
};

class RegistryTest : public testing::Test {
 protected:
  RegistryTest() {
    registry.add(Role::heuristic, NullHeuristic::info(), [](const Params& p) { return std::make_unique<NullHeuristic>(p); });
  }
  Registry registry;

  std::string message_of(std::map<std::string, ParamValue, std::less<>> changes) {
    try {
      (void)registry.ref(Role::heuristic, "null", std::move(changes));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(RegistryTest, CompletesWithDefaultsAndTakesAnIntegerForAReal) {
  const MethodRef ref = registry.ref(Role::heuristic, "null", {{"scale", std::int64_t{3}}});
  EXPECT_EQ(canonical(ref), "null{bins=16, centres=box, scale=3}");
  EXPECT_EQ(registry.create<Heuristic>(ref)->prepare({}, {}), surface_area());
}

TEST_F(RegistryTest, RefusesWrongTypesRangesChoicesAndNames) {
  EXPECT_EQ(message_of({{"bins", 2.5}}), "heuristic 'null': parameter 'bins' is the number 2.5; expected an integer in [2, 256]");
  EXPECT_EQ(message_of({{"bins", std::int64_t{1}}}),
            "heuristic 'null': parameter 'bins' is the integer 1; expected an integer in [2, 256]");
  EXPECT_EQ(
      message_of({{"centres", "centrod"}}),
      "heuristic 'null': parameter 'centres' is the text 'centrod'; expected one of box, centroid; did you mean 'centroid'?");
  EXPECT_EQ(message_of({{"scal", 1.0}}),
            "heuristic 'null' has no parameter 'scal'; expected one of scale, bins, centres; did you mean 'scale'?");
}

TEST_F(RegistryTest, NamesTheNearestMethod) {
  EXPECT_THROW(
      {
        try {
          (void)registry.get(Role::heuristic, "nul");
        } catch (const Error& error) {
          EXPECT_STREQ(error.what(), "there is no heuristic 'nul'; expected one of null; did you mean 'null'?");
          throw;
        }
      },
      Error);
}

TEST_F(RegistryTest, KeepsTheFirstOfTwoPluginsOfOneNameAndReportsBoth) {
  registry.set_origin("/plugins/second.so");
  registry.add(Role::heuristic, NullHeuristic::info(), [](const Params& p) { return std::make_unique<NullHeuristic>(p); });
  try {
    registry.require_no_conflicts();
    FAIL() << "no conflict reported";
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "two plugins register the heuristic 'null': one from built in, one from /plugins/second.so; expected one method a "
        "name and role");
  }
}

}  // namespace
}  // namespace raystudy
