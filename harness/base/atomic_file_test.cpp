#include "harness/base/atomic_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// A process that has ended.
pid_t dead_process() {
  const pid_t pid = fork();
  if (pid == 0) _exit(0);
  waitpid(pid, nullptr, 0);
  return pid;
}

class StaleTemporariesTest : public testing::Test {
 protected:
  StaleTemporariesTest() : folder(fs::path(testing::TempDir()) / fmt::format("stale-{}", getpid())) {
    fs::create_directories(folder / "figures");
  }
  void TearDown() override { fs::remove_all(folder); }

  [[nodiscard]] fs::path make(const std::string& name, std::chrono::seconds age) const {
    fs::path file = folder / name;
    std::ofstream(file) << "half a res";
    fs::last_write_time(file, fs::file_time_type::clock::now() - age);
    return file;
  }

  fs::path folder;
};

TEST_F(StaleTemporariesTest, FilesOfKilledProcessesGo) {
  const fs::path result = make(fmt::format(".0123abcd.json.{}.tmp", dead_process()), std::chrono::hours(1));
  const fs::path below = make(fmt::format("figures/.a.svg.{}.tmp", dead_process()), std::chrono::hours(1));
  remove_stale_temporaries(folder);
  EXPECT_FALSE(fs::exists(result));
  EXPECT_FALSE(fs::exists(below));
}

TEST_F(StaleTemporariesTest, FilesThatMayBeInUseStay) {
  const fs::path living = make(fmt::format(".0123abcd.json.{}.tmp", getpid()), std::chrono::hours(1));
  const fs::path fresh = make(fmt::format(".4567abcd.json.{}.tmp", dead_process()), std::chrono::seconds(5));
  remove_stale_temporaries(folder);
  EXPECT_TRUE(fs::exists(living));
  EXPECT_TRUE(fs::exists(fresh)) << "a process of another machine may be writing it";
}

TEST_F(StaleTemporariesTest, OtherFilesStay) {
  const pid_t dead = dead_process();
  for (const std::string& name : {std::string("0123abcd.json"), fmt::format("notes.{}.tmp", dead), std::string(".notes.tmp"),
                                  fmt::format(".notes.{}x.tmp", dead), std::string(".notes.0.tmp"), std::string(".tmp")}) {
    const fs::path file = make(name, std::chrono::hours(1));
    remove_stale_temporaries(folder);
    EXPECT_TRUE(fs::exists(file)) << name;
  }
}

TEST_F(StaleTemporariesTest, AFolderThatIsNotThereIsNoMistake) { remove_stale_temporaries(folder / "absent"); }

}  // namespace
}  // namespace raystudy
