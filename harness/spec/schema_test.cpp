#include "harness/spec/schema.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace raystudy {
namespace {

TEST(Schema, KnowsEveryRegisteredMethodWithItsParameters) {
  const nlohmann::json schema = nlohmann::json::parse(experiment_schema());
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_FALSE(schema["additionalProperties"]);
  const nlohmann::json& builders = schema["$defs"]["builder"]["anyOf"];
  EXPECT_NE(std::find(builders[0]["enum"].begin(), builders[0]["enum"].end(), "test-builder"), builders[0]["enum"].end());
  for (const nlohmann::json& builder : builders) {
    if (!builder.contains("properties") || !builder["properties"].contains("test-builder")) continue;
    const nlohmann::json& bins = builder["properties"]["test-builder"]["properties"]["bins"];
    EXPECT_EQ(bins["description"], "bins");
    EXPECT_EQ(bins["anyOf"][0]["anyOf"][0]["minimum"], 2);
    EXPECT_EQ(bins["anyOf"][0]["anyOf"][0]["maximum"], 256);
    return;
  }
  FAIL() << "no test-builder";
}

}  // namespace
}  // namespace raystudy
