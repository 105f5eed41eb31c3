#include "harness/spec/cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "harness/spec/cell_id.h"
#include "harness/spec/rays.h"

namespace raystudy {
namespace {

using testing::ElementsAre;

const std::string study =
    "scenes: [sibenik-ogre, conference, terrain: {triangles: 1000}]\n"
    "methods: {a: test-builder, b: {builder: {test-builder: {bins: 4}}}}\n"
    "tracers: [test-tracer]\nworkloads: {few: {test-rays: {count: 10}}, many: {test-rays: {count: 20}}}\n";

Plan read(const std::string& text = study) { return parse_plan(text, "x.yaml", Scale::quick); }

std::vector<std::string> paths(const Plan& plan) {
  std::vector<std::string> all;
  for (const Cell& cell : plan.cells) all.push_back(cell_path(plan, cell));
  return all;
}

std::vector<std::string> selected(std::string_view only, Shard shard = {}) {
  Plan plan = read();
  select_cells(plan, only, shard);
  return paths(plan);
}

TEST(Cells, SceneBySceneEachBuildBeforeItsRays) {
  const Plan plan = read();
  EXPECT_EQ(plan.cells.size(), 3U * 2U * 3U);
  const std::vector<std::string> all = paths(plan);
  EXPECT_THAT(std::vector(all.begin(), all.begin() + 4), ElementsAre("sibenik-ogre/a", "sibenik-ogre/a/test-tracer/few",
                                                                     "sibenik-ogre/a/test-tracer/many", "sibenik-ogre/b"));
}

TEST(Cells, GlobsMatchPartByPart) {
  EXPECT_TRUE(path_matches("sibenik*", "sibenik-ogre/a/t/w"));
  EXPECT_TRUE(path_matches("*/a", "sibenik-ogre/a"));
  EXPECT_TRUE(path_matches("*/a", "sibenik-ogre/a/t/w"));
  EXPECT_TRUE(path_matches("*/a[k=0.5]", "s/a[k=0.5]"));
  EXPECT_TRUE(path_matches("s/?/t/*", "s/a/t/w"));
  EXPECT_TRUE(path_matches("*a*b*", "xaybz"));
  EXPECT_FALSE(path_matches("*/b", "sibenik-ogre/a"));
  EXPECT_FALSE(path_matches("sibenik", "sibenik-ogre/a"));
  EXPECT_FALSE(path_matches("*w", "s/a/t/w")) << "a star stays within its part";
  EXPECT_FALSE(path_matches("s/a/t/w", "s/a")) << "a build cell has no tracer";
  EXPECT_TRUE(path_matches("s/a/*", "s/a"));
}

TEST(Cells, OnlyAndShardChooseAndNothingIsLostOrTwice) {
  EXPECT_THAT(selected("conference/b"),
              ElementsAre("conference/b", "conference/b/test-tracer/few", "conference/b/test-tracer/many"));
  EXPECT_THAT(selected("*/a/*/many"), testing::SizeIs(3));
  std::multiset<std::string> all;
  for (int i = 1; i <= 2; ++i) {
    for (const std::string& path : selected({}, {i, 2})) all.insert(path);
  }
  const std::vector<std::string> whole = paths(read());
  EXPECT_EQ(all, std::multiset<std::string>(whole.begin(), whole.end()));
  EXPECT_THAT(selected("*/a/*/few", {2, 3}), ElementsAre("conference/a/test-tracer/few"));
  EXPECT_TRUE(selected({}, {4, 4}).empty());
}

std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Cells, RefusesWhatNamesNothing) {
  EXPECT_EQ(message([] { (void)selected("sponza"); }),
            "x.yaml: --only 'sponza' names no cell; expected scene/method/tracer/workload, where * stands for anything, such as "
            "'terrain/b/test-tracer/many'");
  for (const std::string text : {"", "1", "0/2", "3/2", "1/2/3", "a/2", "1/", "-1/2"}) {
    EXPECT_EQ(message([&] { (void)read_shard(text); }), "--shard is '" + text + "'; expected i/n with 1 <= i <= n, such as 1/4");
  }
  EXPECT_EQ(read_shard("2/3").index, 2);
  EXPECT_EQ(read_shard("2/3").count, 3);
}

TEST(CellId, IsTheSameForTheSameAndAnotherForWhateverCanChangeANumber) {
  const Plan plan = read();
  const std::string build = cell_id(plan, plan.cells[0]);
  const std::string traced = cell_id(plan, plan.cells[1]);
  EXPECT_EQ(build.size(), 32U);
  EXPECT_EQ(build.find_first_not_of("0123456789abcdef"), std::string::npos);
  std::set<std::string> all;
  for (const Cell& cell : plan.cells) all.insert(cell_id(plan, cell));
  EXPECT_EQ(all.size(), plan.cells.size());
  EXPECT_EQ(cell_id(read(), plan.cells[0]), build);

  for (const std::string same :
       {"title: other\n", "timeout: 3 s\n", "memory_limit: 1 GiB\n", "repetitions: 3\n", "tables: {}\n"}) {
    EXPECT_EQ(cell_id(read(study + same), plan.cells[0]), build) << same;
  }
  for (const std::string other : {"seed: 2\n", "threads: 2\n", "repetitions: 4\n", "warm_up: 1 s\n", "cost: {c_T: 1}\n"}) {
    EXPECT_NE(cell_id(read(study + other), plan.cells[0]), build) << other;
    EXPECT_NE(cell_id(read(study + other), plan.cells[1]), traced) << other;
  }
  // What is measured of the tree says nothing about its rays.
  EXPECT_NE(cell_id(read(study + "metrics: []\n"), plan.cells[0]), build);
  EXPECT_EQ(cell_id(read(study + "metrics: []\n"), plan.cells[1]), traced);
}

TEST(CellId, ThreadsAreAMethodsOwn) {
  const auto of = [](const std::string& threads, const std::string& method) {
    const Plan plan =
        parse_plan(threads + "scenes: [conference]\nmethods: {a: {builder: test-builder" + method + "}, b: {from: a}}\n",
                   "x.yaml", Scale::quick);
    return std::pair{cell_id(plan, plan.cells[0]), cell_id(plan, plan.cells[1])};
  };
  const auto one = of("", "");
  EXPECT_EQ(of("threads: 2\n", ", threads: 1"), one);
  EXPECT_EQ(of("threads: 2\n", ""), of("", ", threads: 2")) << "'from' takes them over";
  EXPECT_NE(of("", ", threads: 2").first, one.first);
}

TEST(CellId, IdentitySaysInWordsWhatItDependsOn) {
  const Plan plan = read();
  const std::string text = cell_identity(plan, plan.cells.back());
  EXPECT_THAT(text,
              testing::StartsWith("scene: terrain = terrain triangles=1000 seed=1\nmethod: b\nbuilder: test-builder{bins=4, "));
  EXPECT_THAT(text, testing::HasSubstr("workload: test-rays{count=20}\n"));
  EXPECT_THAT(text, testing::HasSubstr("cost: c_T=3 c_I=2\nheuristic: surface-area{}\n"));
  EXPECT_THAT(text, testing::HasSubstr("code: " + std::string(code_hash()) + "\n"));
  EXPECT_EQ(code_hash().size(), 64U);
}

TEST(CellId, AFilesHashIsOfItsBytes) {
  const auto path = std::filesystem::temp_directory_path() / "raystudy-file-hash";
  std::ofstream(path) << "abc";
  EXPECT_EQ(file_hash(path.string()), "06b05ab6733a618578af5f94892f3950");  // XXH3-128 of "abc", as xxhsum -H128 prints it
  std::filesystem::remove(path);
  EXPECT_EQ(file_hash(path.string()), std::nullopt);
}

TEST(Rays, AreCountedFromTheParameters) {
  const Plan plan = read();
  EXPECT_EQ(estimated_rays(plan.workloads[1].workload), 20U);
}

}  // namespace
}  // namespace raystudy
