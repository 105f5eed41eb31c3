#include "harness/run/result.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <limits>

#include "harness/base/error.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

constexpr const char* cure = "; expected a result as 'raystudy run' writes it (delete the file to have its cell measured again)";

class ResultTest : public testing::Test {
 public:
  ResultTest() : folder(fs::path(testing::TempDir()) / fmt::format("result-{}", getpid())) { fs::create_directories(folder); }
  ~ResultTest() override { fs::remove_all(folder); }

 protected:
  static CellResult sample() {
    CellResult r;
    r.id = "0123abcd";
    r.experiment = "table1";
    r.scene = "sibenik";
    r.method = "insertion[batch=2]";
    r.tracer = "scalar";
    r.workload = "primary";
    r.values["cost"] = {ValueClass::exact, "", {82.25378418}};
    r.values["trace_time"] = {ValueClass::absolute, "s", {0.1, 0.3, 1.0 / 3}};
    r.series["cost_over_time"] = {"time", "s", "", {0, 0.5}, {100, 80}};
    r.provenance["cpu"] = "a \"quoted\" name\n";
    return r;
  }

  [[nodiscard]] std::string error_of(const std::string& text) const {
    const fs::path file = folder / "x.json";
    std::ofstream(file) << text;
    try {
      (void)read_result(file);
    } catch (const Error& error) {
      const std::string what = error.what();
      return what.starts_with(file.string()) ? what.substr(file.string().size()) : what;
    }
    return "no error";
  }

  fs::path folder;
};

TEST_F(ResultTest, MedianIsTheMiddleOrTheMeanOfTheTwoMiddleSamples) {
  EXPECT_EQ((Measurement{ValueClass::absolute, "s", {3, 1, 2}}.median()), 2);
  EXPECT_EQ((Measurement{ValueClass::absolute, "s", {4, 1, 2, 8}}.median()), 3);
  EXPECT_TRUE(std::isnan(Measurement{}.median()));
}

TEST_F(ResultTest, ReadsBackExactlyWhatWasWritten) {
  write_result(folder / "deep" / "er", sample());
  EXPECT_EQ(read_result(folder / "deep" / "er" / "0123abcd.json"), sample());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep" / "er"), {}), 1) << "a temporary file was left behind";
}

TEST_F(ResultTest, SaysWhereTheJsonBreaks) {
  const std::string whole = result_to_json(sample());
  const std::string cut = whole.substr(0, whole.size() / 2);
  const auto lines = std::count(cut.begin(), cut.end(), '\n') + 1;
  const std::size_t column = cut.size() - cut.rfind('\n');
  EXPECT_EQ(error_of(cut), fmt::format(":{}:{}: the result breaks off{}", lines, column, cure));
  EXPECT_EQ(error_of("{\"id\": 1,\n oops}"), fmt::format(":2:2: the result is not valid JSON from here on{}", cure));
  EXPECT_EQ(error_of(""), fmt::format(": the result is empty{}", cure));
}

TEST_F(ResultTest, SaysWhatIsMissingOrWrongInTheJson) {
  EXPECT_EQ(error_of("{}"), fmt::format(": not a result: key 'format' not found{}", cure));
  EXPECT_EQ(error_of("{\"format\": 7}"), fmt::format(": not a result: its format is 7, this Raystudy knows 1{}", cure));
  std::string text = result_to_json(sample());
  text.replace(text.find("\"done\""), 6, "\"dome\"");
  EXPECT_EQ(error_of(text), fmt::format(": not a result: 'dome' is no status{}", cure));
  CellResult uneven = sample();
  uneven.series["cost_over_time"].y.pop_back();
  EXPECT_EQ(error_of(result_to_json(uneven)),
            fmt::format(": not a result: series 'cost_over_time' has 2 numbers on x and 1 on y{}", cure));
}

TEST_F(ResultTest, MissingFileIsNamedWithTheReason) {
  const fs::path file = folder / "none.json";
  try {
    (void)read_result(file);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), fmt::format("{}: cannot read the result: No such file or directory", file.string()));
  }
}

TEST_F(ResultTest, ANumberThatIsNotFiniteIsAProgrammersMistake) {
  CellResult r = sample();
  r.values["cost"].samples = {std::numeric_limits<double>::infinity()};
  EXPECT_THROW((void)result_to_json(r), std::logic_error);
}

TEST_F(ResultTest, AFileInTheWayOfTheFolderIsNamed) {
  std::ofstream(folder / "file") << "x";
  try {
    write_result(folder / "file", sample());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), fmt::format("{}: cannot make the folder: Not a directory", (folder / "file").string()));
  }
}

/// In a process of its own, whose files may not grow past a kilobyte: the write fails half-way, as on a full disk.
TEST_F(ResultTest, AFullDiskLeavesTheOldResultAndNothingElse) {
  CellResult old = sample();
  write_result(folder, old);
  const pid_t child = fork();
  if (child == 0) {
    (void)std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{512, 512};
    setrlimit(RLIMIT_FSIZE, &small);
    CellResult large = sample();
    large.values["cost"].samples.assign(1000, 1.5);
    int code = 1;
    try {
      write_result(folder, large);
    } catch (const Error& error) {
      code = error.what() == fmt::format("{}: cannot write: File too large", result_file(folder, old.id).string()) ? 0 : 2;
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(read_result(result_file(folder, old.id)), old);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "a temporary file was left behind";
}

}  // namespace
}  // namespace raystudy
