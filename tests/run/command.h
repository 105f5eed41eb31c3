#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace raystudy {

/// The executable, running with its output in files.
class Command {
 public:
  /// No file may grow beyond `file_bytes`; 0: no limit.
  Command(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
          const std::map<std::string, std::string>& environment = {}, long file_bytes = 0);
  Command(const Command&) = delete;
  Command& operator=(const Command&) = delete;
  ~Command();

  void signal(int number) const;
  /// Its exit code, or 128 + the signal that ended it, as a shell says.
  int wait();
  [[nodiscard]] pid_t pid() const { return pid_; }
  [[nodiscard]] std::vector<pid_t> children() const;
  [[nodiscard]] std::string out() const;
  [[nodiscard]] std::string err() const;

 private:
  std::filesystem::path out_;
  std::filesystem::path err_;
  pid_t pid_ = -1;
};

/// True while there is such a process that has not ended.
[[nodiscard]] bool is_alive(pid_t pid);

}  // namespace raystudy
