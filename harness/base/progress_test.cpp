#include "harness/base/progress.h"

#include <gtest/gtest.h>

#include <functional>

namespace raystudy {
namespace {

std::string written(const std::function<void(std::FILE*)>& write) {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* stream = open_memstream(&text, &size);
  write(stream);
  std::fclose(stream);
  std::string result(text, size);
  std::free(text);  // NOLINT: open_memstream allocates with malloc
  return result;
}

TEST(Progress, WritesPlainLinesWhereThereIsNoTerminal) {
  const std::string text = written([](std::FILE* stream) {
    Progress progress("download", 200, 0.25, stream);
    progress.update(10);
    progress.update(60);
    progress.update(70);
    progress.line("a note");
    progress.update(160);
    progress.update(200);
  });
  EXPECT_EQ(text, "download: 30 %\na note\ndownload: 80 %\ndownload: 100 %\n");
}

TEST(Progress, DrawsABarOnATerminalAndTakesItAway) {
  const std::string text = written([](std::FILE* stream) {
    Progress progress("run", 4, Progress::Style{true, 0}, stream);
    progress.line("first cell done");
  });
  const std::string bar = "\rrun [........................]   0 %    \x1b[K";
  EXPECT_EQ(text, bar + "\r\x1b[K" + "first cell done\n" + bar + "\r\x1b[K");
}

TEST(Progress, TextsOfDurationsAndSizes) {
  EXPECT_EQ(duration_text(0.04), "0.0 s");
  EXPECT_EQ(duration_text(9.96), "10 s");
  EXPECT_EQ(duration_text(200), "3 min 20 s");
  EXPECT_EQ(duration_text(7500), "2 h 05 min");
  EXPECT_EQ(bytes_text(512), "512 B");
  EXPECT_EQ(bytes_text(1536), "1.5 KiB");
  EXPECT_EQ(bytes_text(20.0 * 1024 * 1024), "20 MiB");
}

}  // namespace
}  // namespace raystudy
