#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace raystudy {

/// What a run of the executable came to.
struct Outcome {
  int code = 0;
  std::string text;  ///< standard output and error
};

/// `environment`: variables of the shell, NAME=value, for this run.
inline Outcome raystudy(const std::string& arguments, const std::string& environment = "") {
  const std::string command = environment + " " + std::string(RAYSTUDY_BINARY_DIR) + "/bin/raystudy " + arguments + " 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  Outcome outcome;
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) outcome.text += buffer.data();
  outcome.code = WEXITSTATUS(::pclose(pipe));
  return outcome;
}

}  // namespace raystudy
