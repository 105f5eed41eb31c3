#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace raystudy::cli {

/// What the process returns; documented in README.md.
enum ExitCode : int {
  exit_ok = 0,
  exit_failed_rows = 1,   ///< the study ran to its end, but some cells failed
  exit_bad_input = 2,     ///< a flag, file or environment variable is wrong, or a file cannot be written (a full disk); results
                          ///< written before are kept
  exit_internal = 3,      ///< a mistake in Raystudy or a plugin
  exit_interrupted = 130  ///< SIGINT or SIGTERM; what was measured is kept
};

/// Declares a verb's options on its subcommand and returns what to run after parsing; that returns an ExitCode.
using VerbSetup = std::function<std::function<int()>(CLI::App&)>;

/// A static object of this in a verb's file adds the verb.
struct Verb {
  Verb(std::string name, std::string summary, VerbSetup setup);
};

}  // namespace raystudy::cli
