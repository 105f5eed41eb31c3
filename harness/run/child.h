#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>

namespace raystudy {

/// A forked process that runs `work` with one end of a socket pair, and then ends without returning. It dies with its parent
/// (also where that is killed by SIGKILL), leaves SIGINT to it, and is the first to go where the system runs out of memory.
class Child {
 public:
  explicit Child(const std::function<void(int socket)>& work);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();  ///< kills it where it still runs

  [[nodiscard]] int socket() const { return socket_; }
  void kill();
  /// Waits for its end. Nothing where it ended well, else how: "SIGSEGV", "exit code 3".
  [[nodiscard]] std::optional<std::string> wait();

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
};

/// SIGINT, SIGTERM and SIGHUP set a flag while it lives; they interrupt `wait_readable` only, so that none is missed between
/// looking at the flag and waiting.
class InterruptWatch {
 public:
  InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;
  ~InterruptWatch();

  [[nodiscard]] static bool interrupted();
  /// Waits until `file` can be read, `seconds` have passed (infinity: forever) or a signal came. True where it can be read.
  [[nodiscard]] static bool wait_readable(int file, double seconds);
};

}  // namespace raystudy
