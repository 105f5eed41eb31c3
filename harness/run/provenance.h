#pragma once

#include <map>
#include <string>
#include <vector>

#include "harness/spec/plan.h"

namespace raystudy {

/// How this Raystudy was built.
struct BuildInfo {
  std::string commit;    ///< "unknown" where it was not built from a repository
  std::string dirty;     ///< "yes" where files differed from the commit, "no", or "unknown"
  std::string compiler;  ///< e.g. "GNU 12.2.0"
  std::string flags;
  std::string build_type;
  std::vector<std::pair<std::string, std::string>> libraries;  ///< name → version
};
[[nodiscard]] const BuildInfo& build_info();

/// What every result of one run says of where it comes from: commit, code hash, compiler, flags, libraries, the machine and its
/// state at the start, threads, seed, repetitions, command. No name of a host or user.
[[nodiscard]] std::map<std::string, std::string> run_provenance(const Plan& plan, const std::string& command);

/// This process's command line, its words quoted for a shell where needed.
[[nodiscard]] std::string command_line();

/// ISO 8601 in UTC: 2026-01-31T12:00:00Z.
[[nodiscard]] std::string utc_now();

}  // namespace raystudy
