#include "harness/spec/parse_pipeline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "harness/base/error.h"

namespace raystudy {
namespace {

std::string error_of(const PipelineText& text) {
  try {
    (void)parse_pipeline(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParsePipeline, TakesMethodsAsExperimentsWriteThem) {
  const PipelineSpec spec = parse_pipeline(
      {.builder = "sweep-sah: {leaves: sah}", .optimizers = {"insertion: {p_R: 2}", "compaction"}, .encoder = "bvh8"});
  EXPECT_EQ(spec.label, "sweep-sah + insertion + compaction + bvh8");
  EXPECT_EQ(spec.builder.name, "sweep-sah");
  EXPECT_EQ(spec.builder.params->text("leaves"), "sah");
  ASSERT_EQ(spec.optimizers.size(), 2U);
  EXPECT_EQ(spec.optimizers[0].params->integer("p_R"), 2);
  EXPECT_EQ(spec.optimizers[1].name, "compaction");
  ASSERT_TRUE(spec.encoder);
  EXPECT_EQ(spec.encoder->name, "bvh8");
  EXPECT_FALSE(parse_pipeline({.builder = "sweep-sah"}).encoder);
}

TEST(ParsePipeline, ShowsAllMistakesWithTheirFlags) {
  EXPECT_THAT(error_of({.builder = "sweep-sah: {leaves: many}", .optimizers = {"compaction", "compactor"}}),
              testing::AllOf(
                  testing::StartsWith("--builder:1:21: builder 'sweep-sah': parameter 'leaves' is the text 'many'; expected "
                                      "one of single, sah\n--optimize:1:1: there is no optimizer 'compactor'; expected one of "),
                  testing::EndsWith("; did you mean 'compaction'?")));
  EXPECT_EQ(error_of({.builder = "embree", .encoder = "bvh8"}),
            "--encode:1:1: encoder 'bvh8' cannot take what builder 'embree' makes ('embree'); expected a builder of 'bvh2'");
  EXPECT_EQ(error_of({.builder = ""}),
            "--builder: the builder is nothing; expected NAME or {NAME: {parameter: value}}, with the name of a builder");
  EXPECT_EQ(error_of({.builder = "sweep-sah: {leaves: [single, sah]}"}),
            "the methods make 2 pipelines; expected one: a single value everywhere");
}

}  // namespace
}  // namespace raystudy
