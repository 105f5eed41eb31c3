#include "harness/run/child.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <system_error>

namespace raystudy {
namespace {

constexpr std::array watched{SIGINT, SIGTERM, SIGHUP};

volatile std::sig_atomic_t interrupt_flag = 0;
sigset_t mask_before;
std::array<struct sigaction, watched.size()> actions_before;

sigset_t watched_set() {
  sigset_t set;
  sigemptyset(&set);
  for (const int s : watched) sigaddset(&set, s);
  return set;
}

[[noreturn]] void run_child(pid_t parent, const std::function<void(int)>& work, int socket) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it died before prctl
  // A terminal sends SIGINT to the whole group; what comes of it is the parent's to say.
  for (const int s : watched) (void)std::signal(s, SIG_IGN);
  const sigset_t set = watched_set();
  sigprocmask(SIG_UNBLOCK, &set, nullptr);
  std::ofstream("/proc/self/oom_score_adj") << "1000";
  try {
    work(socket);
  } catch (const std::exception& error) {
    fmt::print(stderr, "raystudy: a worker ended: {}\n", error.what());
    _exit(1);
  }
  std::fflush(nullptr);
  _exit(0);
}

}  // namespace

Child::Child(const std::function<void(int)>& work) {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot make a socket pair");
  }
  std::fflush(nullptr);  // else the child would write out what is buffered a second time
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) {
    const int code = errno;
    close(ends[0]);
    close(ends[1]);
    throw std::system_error(code, std::generic_category(), "cannot start a worker");
  }
  if (pid_ == 0) {
    close(ends[0]);
    run_child(parent, work, ends[1]);
  }
  close(ends[1]);
  socket_ = ends[0];
}

Child::~Child() {
  if (pid_ > 0) {
    kill();
    (void)wait();
  }
  close(socket_);
}

void Child::kill() { ::kill(pid_, SIGKILL); }

std::optional<std::string> Child::wait() {
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  if (WIFSIGNALED(status)) {
    const char* name = sigabbrev_np(WTERMSIG(status));
    return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", WTERMSIG(status));
  }
  if (WEXITSTATUS(status) != 0) return fmt::format("exit code {}", WEXITSTATUS(status));
  return std::nullopt;
}

InterruptWatch::InterruptWatch() {
  interrupt_flag = 0;
  struct sigaction action {};
  action.sa_handler = [](int) { interrupt_flag = 1; };
  for (std::size_t i = 0; i < watched.size(); ++i) sigaction(watched.at(i), &action, &actions_before.at(i));
  const sigset_t set = watched_set();
  sigprocmask(SIG_BLOCK, &set, &mask_before);
}

InterruptWatch::~InterruptWatch() {
  for (std::size_t i = 0; i < watched.size(); ++i) sigaction(watched.at(i), &actions_before.at(i), nullptr);
  sigprocmask(SIG_SETMASK, &mask_before, nullptr);
}

bool InterruptWatch::interrupted() {
  // Takes a pending signal away: left there, it would end the process as soon as it is let through again.
  const sigset_t set = watched_set();
  constexpr timespec at_once{};
  while (sigtimedwait(&set, nullptr, &at_once) > 0) interrupt_flag = 1;
  return interrupt_flag != 0;
}

bool InterruptWatch::wait_readable(int file, double seconds) {
  pollfd entry{file, POLLIN, 0};
  timespec limit{};
  const bool forever = std::isinf(seconds);
  if (!forever) {
    const double positive = std::max(0.0, seconds);
    limit.tv_sec = static_cast<time_t>(positive);
    limit.tv_nsec = static_cast<long>((positive - std::floor(positive)) * 1e9);
  }
  return ppoll(&entry, 1, forever ? nullptr : &limit, &mask_before) > 0;
}

}  // namespace raystudy
