#include "tests/run/command.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

namespace raystudy {
namespace {

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void redirect(const std::filesystem::path& file, int descriptor) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  dup2(opened, descriptor);
}

}  // namespace

Command::Command(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                 const std::map<std::string, std::string>& environment, long file_bytes)
    : out_(folder / "out"), err_(folder / "err") {
  pid_ = fork();
  if (pid_ != 0) return;
  redirect(out_, STDOUT_FILENO);
  redirect(err_, STDERR_FILENO);
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  if (file_bytes > 0) {
    (void)std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{static_cast<rlim_t>(file_bytes), static_cast<rlim_t>(file_bytes)};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::string program = RAYSTUDY_BINARY_DIR "/bin/raystudy";
  std::vector<std::string> words = arguments;
  std::vector<char*> pointers{program.data()};
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(program.c_str(), pointers.data());
  _exit(127);
}

Command::~Command() {
  if (pid_ <= 0) return;
  signal(SIGKILL);
  (void)wait();
}

void Command::signal(int number) const { kill(pid_, number); }

int Command::wait() {
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::vector<pid_t> Command::children() const {
  std::istringstream list(content(fmt::format("/proc/{0}/task/{0}/children", pid_)));
  return {std::istream_iterator<pid_t>(list), {}};
}

std::string Command::out() const { return content(out_); }
std::string Command::err() const { return content(err_); }

bool is_alive(pid_t pid) {
  const std::string stat = content(fmt::format("/proc/{}/stat", pid));
  const std::size_t close = stat.rfind(')');
  // A zombie has ended; who collects it is the system's affair.
  return close != std::string::npos && stat.compare(close, 3, ") Z") != 0;
}

}  // namespace raystudy
