#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "harness/run/result.h"
#include "tests/run/command.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr const char* experiment = R"(title: A small study
repetitions: 2
scenes:
  - soup: {triangles: [1000, 2000]}
methods:
  sweep: {builder: sweep-sah}
  binned: {builder: binned-sah}
tracers: [scalar]
workloads:
  random: {random: {count: 500}}
tables:
  sizes:
    rows: method
    columns:
      cost: {metric: cost}
)";
constexpr std::size_t cell_count = 8;  // 2 scenes, 2 builds and 2 traces each

class RunVerb : public testing::Test {
 protected:
  RunVerb() : folder(fs::path(testing::TempDir()) / fmt::format("run-verb-{}", getpid())), yaml(folder / "small.yaml") {
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(yaml) << experiment;
  }
  ~RunVerb() override { fs::remove_all(folder); }

  [[nodiscard]] std::vector<std::string> run_words(const fs::path& results, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"run", yaml.string(), "--results", results.string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static std::vector<fs::path> results_in(const fs::path& results) {
    std::vector<fs::path> files;
    if (!fs::exists(results / "small")) return files;
    for (const auto& entry : fs::directory_iterator(results / "small")) {
      if (entry.path().extension() == ".json") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
  }
  static bool wait_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 60'000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  fs::path folder;
  fs::path yaml;
};

TEST_F(RunVerb, ADeviceThatIsNotThereIsBadInput) {
  Command command(folder, run_words(folder / "results", {"--device", "no-such-device"}));
  EXPECT_EQ(command.wait(), 2);
  EXPECT_THAT(command.err(),
              testing::ContainsRegex("there is no (device 'no-such-device'; expected a number below|Vulkan device)"));
  EXPECT_TRUE(results_in(folder / "results").empty());
}

TEST_F(RunVerb, WithoutADriverCellsOnADeviceFailAndTheOthersGoOn) {
  std::string text = experiment;
  const std::string builder = "binned-sah";
  text.replace(text.find(builder), builder.size(), "gpu-lbvh");
  std::ofstream(yaml) << text;
  Command command(folder, run_words(folder / "results"), {{"VK_ICD_FILENAMES", "/none"}, {"VK_DRIVER_FILES", "/none"}});
  EXPECT_EQ(command.wait(), 1);
  EXPECT_THAT(command.err(), HasSubstr("binned: error while building: there is no Vulkan driver on this machine"));
  EXPECT_THAT(command.err(), HasSubstr("cells: 4 measured, 0 reused, 4 failed, 0 missing"));
}

TEST_F(RunVerb, WithoutADriverThereAreNoDevices) {
  Command command(folder, {"list", "devices"}, {{"VK_ICD_FILENAMES", "/none"}, {"VK_DRIVER_FILES", "/none"}});
  EXPECT_EQ(command.wait(), 0);
  EXPECT_EQ(command.out(), "there is no Vulkan device on this machine\n");
}

TEST_F(RunVerb, MeasuresPrintsTheTableAndReusesWhatIsThere) {
  Command first(folder, run_words(folder / "r"));
  EXPECT_EQ(first.wait(), 0) << first.err();
  EXPECT_THAT(first.err(), HasSubstr("[8/8] "));
  EXPECT_THAT(first.err(), HasSubstr("cells: 8 measured, 0 reused, 0 failed, 0 missing\n"));
  EXPECT_THAT(first.out(), HasSubstr("sweep"));
  EXPECT_EQ(results_in(folder / "r").size(), cell_count);
  EXPECT_TRUE(fs::exists(folder / "r" / "small" / "google-benchmark"));
  Command third(folder, {"run", yaml.string()}, {{"RAYSTUDY_RESULTS", (folder / "r").string()}});
  EXPECT_EQ(third.wait(), 0);
  EXPECT_THAT(third.err(), HasSubstr("cells: 0 measured, 8 reused, 0 failed, 0 missing\n"));
}

TEST_F(RunVerb, KillingItLosesNothingThatIsMeasured) {
  const fs::path results = folder / "r";
  Command killed(folder, run_words(results));
  ASSERT_TRUE(wait_until([&] { return !results_in(results).empty() && !killed.children().empty(); }));
  const std::vector<pid_t> workers = killed.children();
  killed.signal(SIGKILL);
  EXPECT_EQ(killed.wait(), 128 + SIGKILL);
  for (const pid_t worker : workers) EXPECT_TRUE(wait_until([worker] { return !is_alive(worker); })) << "a worker lives on";
  std::map<fs::path, fs::file_time_type> kept;
  for (const fs::path& file : results_in(results)) {
    EXPECT_EQ(read_result(file).status, CellStatus::done);
    kept[file] = fs::last_write_time(file);
  }
  EXPECT_LT(kept.size(), cell_count);
  Command resumed(folder, run_words(results));
  EXPECT_EQ(resumed.wait(), 0);
  EXPECT_THAT(resumed.err(), HasSubstr(fmt::format("cells: {} measured, {} reused", cell_count - kept.size(), kept.size())));
  EXPECT_EQ(results_in(results).size(), cell_count);
  for (const auto& [file, time] : kept) EXPECT_EQ(fs::last_write_time(file), time) << "measured twice";
}

TEST_F(RunVerb, AnInterruptEndsItWith130AndKeepsWhatIsMeasured) {
  const fs::path results = folder / "r";
  Command interrupted(folder, run_words(results));
  ASSERT_TRUE(wait_until([&] { return !results_in(results).empty() && !interrupted.children().empty(); }));
  const std::vector<pid_t> workers = interrupted.children();
  interrupted.signal(SIGINT);
  EXPECT_EQ(interrupted.wait(), 130);
  for (const pid_t worker : workers) EXPECT_FALSE(is_alive(worker));
  EXPECT_THAT(interrupted.err(),
              testing::EndsWith("interrupted; what is measured is kept, and the same command goes on from there\n"));
  EXPECT_THAT(interrupted.err(), testing::ContainsRegex("cells: [0-9]+ measured, 0 reused, 0 failed, 0 missing, [0-9]+ left\n"));
  for (const fs::path& file : results_in(results)) EXPECT_EQ(read_result(file).status, CellStatus::done);
}

TEST_F(RunVerb, ShardsCopiedTogetherAreTheWhole) {
  Command whole(folder, run_words(folder / "whole"));
  EXPECT_EQ(whole.wait(), 0);
  for (const char* shard : {"1/2", "2/2"}) {
    Command part(folder, run_words(folder / fmt::format("part{}", shard[0]), {"--shard", shard}));
    EXPECT_EQ(part.wait(), 0);
  }
  EXPECT_EQ(results_in(folder / "part1").size(), cell_count / 2);
  fs::copy(folder / "part2", folder / "part1", fs::copy_options::recursive | fs::copy_options::skip_existing);
  Command merged(folder, run_words(folder / "part1"));
  EXPECT_EQ(merged.wait(), 0);
  EXPECT_THAT(merged.err(), HasSubstr("cells: 0 measured, 8 reused"));
  const std::vector<fs::path> expected = results_in(folder / "whole");
  const std::vector<fs::path> found = results_in(folder / "part1");
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const CellResult a = read_result(expected[i]);
    const CellResult b = read_result(found[i]);
    EXPECT_EQ(a.id, b.id);
    for (const auto& [name, value] : a.values) {
      if (value.value_class == ValueClass::exact) {
        EXPECT_EQ(value, b.values.at(name)) << name;
      }
    }
  }
}

TEST_F(RunVerb, OnlyMeasuresWhatIsNamedAndForceMeasuresItAgain) {
  const fs::path results = folder / "r";
  Command some(folder, run_words(results, {"--only", "*/binned"}));
  EXPECT_EQ(some.wait(), 0);
  EXPECT_THAT(some.err(), HasSubstr("cells: 4 measured, 0 reused"));
  Command again(folder, run_words(results, {"--only", "*/binned", "--force"}));
  EXPECT_EQ(again.wait(), 0);
  EXPECT_THAT(again.err(), HasSubstr("cells: 4 measured, 0 reused"));
}

TEST_F(RunVerb, AFolderThatCannotBeWrittenIsRefusedAtOnce) {
  std::ofstream(folder / "file") << "x";
  Command command(folder, run_words(folder / "file"));
  EXPECT_EQ(command.wait(), 2);
  EXPECT_EQ(command.err(), fmt::format("{}: cannot make the folder: Not a directory\n", (folder / "file" / "small").string()));
}

TEST_F(RunVerb, AFullDiskEndsItWithTheReason) {
  const fs::path results = folder / "r";
  Command command(folder, run_words(results, {"--only", "*/binned"}), {}, 2000);
  EXPECT_EQ(command.wait(), 2);
  EXPECT_THAT(command.err(), testing::ContainsRegex("small/[0-9a-f]+\\.json: cannot write: File too large\n$"));
  EXPECT_TRUE(results_in(results).empty());
  EXPECT_TRUE(fs::is_empty(results / "small")) << "a part of a result was left behind";
}

TEST_F(RunVerb, AMisspeltFileIsAnsweredWithTheNearest) {
  const std::string here = folder.string();
  const std::vector<std::pair<std::string, std::string>> cases{
      {here + "/smal.yaml", "No such file or directory; did you mean '" + here + "/small.yaml'?"},
      {here + "/quickstart.yaml", "No such file or directory"},
      {here + "/none/small.yaml", "there is no folder '" + here + "/none'"}};
  for (const char* verb : {"run", "check", "plan", "table", "figure"}) {
    for (const auto& [file, reason] : cases) {
      Command command(folder, {verb, file});
      EXPECT_EQ(command.wait(), 2);
      EXPECT_EQ(command.err(), fmt::format("{}: cannot be read: {}\n", file, reason));
    }
  }
}

TEST_F(RunVerb, AMisspeltPluginIsAnsweredWithTheNearest) {
  const std::string here = folder.string();
  std::ofstream(folder / "libmine.so") << "no library";
  const std::string expected = "expected a shared library, or a folder of them";
  const std::vector<std::pair<std::string, std::string>> cases{
      {here + "/libmien.so", "; " + expected + "; did you mean '" + here + "/libmine.so'?"},
      {here + "/none/libmine.so", ", nor is '" + here + "/none'; " + expected}};
  for (const auto& [path, rest] : cases) {
    Command command(folder, {"list"}, {{"RAYSTUDY_PLUGINS", path}});
    EXPECT_EQ(command.wait(), 2);
    EXPECT_EQ(command.err(), fmt::format("RAYSTUDY_PLUGINS names '{}', which is not there{}\n", path, rest));
  }
}

TEST_F(RunVerb, WrongFlagsAreRefused) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{"--timeout", "0"}, "--timeout is 0; expected a number of seconds > 0\n"},
      {{"--threads", "0"}, "--threads is 0; expected an integer >= 1\n"},
      {{"--repetitions", "-1"}, "--repetitions is -1; expected an integer >= 1\n"}};
  for (const auto& [words, message] : cases) {
    Command command(folder, run_words(folder / "r", words));
    EXPECT_EQ(command.wait(), 2);
    EXPECT_EQ(command.err(), message);
  }
}

TEST_F(RunVerb, ATimeoutIsARowAndTheExitCodeSaysSo) {
  Command command(folder, run_words(folder / "r", {"--timeout", "1e-9", "--only", "soup*1000*/binned"}));
  EXPECT_EQ(command.wait(), 1) << command.err();
  EXPECT_THAT(command.err(), HasSubstr("timed out after 1e-09 s while "));
  EXPECT_THAT(command.err(), HasSubstr("2 failed"));
}

}  // namespace
}  // namespace raystudy
