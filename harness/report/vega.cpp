#include "harness/report/vega.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <vector>

#include "harness/base/error.h"
#include "harness/scene/catalog.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// The folder of render.mjs and package-lock.json: of the source tree, or the installed one.
fs::path script_folder() {
  if (fs::exists(fs::path(RAYSTUDY_SOURCE_VEGA) / "render.mjs")) return RAYSTUDY_SOURCE_VEGA;
  return RAYSTUDY_INSTALLED_VEGA;
}

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::stringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Runs a program to its end and throws Error with what it wrote to standard error where it failed.
void run_program(const std::vector<std::string>& words) {
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw Error(fmt::format("cannot run {}: {}", words.front(), std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  posix_spawn_file_actions_addclose(&actions, ends[1]);
  pid_t process = 0;
  const int failure = posix_spawnp(&process, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  std::string said;
  std::array<char, 4096> part{};
  while (failure == 0) {
    const ssize_t size = ::read(ends[0], part.data(), part.size());
    if (size <= 0) break;
    said.append(part.data(), static_cast<std::size_t>(size));
  }
  ::close(ends[0]);
  if (failure != 0) throw Error(fmt::format("cannot run {}: {}", words.front(), std::strerror(failure)));
  int status = 0;
  ::waitpid(process, &status, 0);
  while (!said.empty() && said.back() == '\n') said.pop_back();
  if (status != 0) throw Error(fmt::format("{} failed: {}", words.front(), said));
}

}  // namespace

fs::path vega_folder() {
  const char* folder = std::getenv("RAYSTUDY_VEGA");
  if (folder != nullptr && *folder != '\0') return folder;
  if (const auto cache = user_cache()) return *cache / "vega";
  throw Error("there is no folder for the user's cache; expected RAYSTUDY_VEGA, XDG_CACHE_HOME or HOME in the environment");
}

std::string vega_problem() {
  if (!is_on_path("node")) return "figures need node: apt-get install nodejs npm";
  const fs::path folder = vega_folder();
  for (const char* package : {"vega", "vega-lite"}) {
    if (fs::exists(folder / "node_modules" / package / "package.json")) continue;
    const std::string from = script_folder().string();
    return fmt::format(
        "figures need the npm package {} in {}: mkdir -p {} && cp {}/package.json {}/package-lock.json {} && npm ci --prefix {}",
        package, (folder / "node_modules").string(), folder.string(), from, from, folder.string(), folder.string());
  }
  if (!is_on_path("rsvg-convert")) return "figures need rsvg-convert: apt-get install librsvg2-bin";
  return {};
}

void render_vega(const fs::path& spec) {
  if (const std::string problem = vega_problem(); !problem.empty()) throw Error(problem);
  fs::path base = spec;
  base.replace_extension().replace_extension();  // NAME.vl.json
  const std::string svg = base.string() + ".svg";
  run_program({"node", (script_folder() / "render.mjs").string(), vega_folder().string(), spec.string(), svg});
  run_program({"rsvg-convert", "--zoom=2", "--background-color=white", "--output=" + base.string() + ".png", svg});
}

}  // namespace raystudy
