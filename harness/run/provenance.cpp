#include "harness/run/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "harness/base/progress.h"
#include "harness/run/machine.h"
#include "harness/spec/cell_id.h"

namespace raystudy {

std::map<std::string, std::string> run_provenance(const Plan& plan, const std::string& command) {
  const BuildInfo& build = build_info();
  const Machine machine = read_machine();
  std::map<std::string, std::string> p{{"commit", build.commit},
                                       {"dirty", build.dirty},
                                       {"code_hash", std::string(code_hash())},
                                       {"compiler", build.compiler},
                                       {"flags", build.flags},
                                       {"build_type", build.build_type},
                                       {"cpu", machine.cpu},
                                       {"microcode", machine.microcode},
                                       {"cores", std::to_string(machine.cores)},
                                       {"memory", bytes_text(machine.memory)},
                                       {"kernel", machine.kernel},
                                       {"governor", machine.governor},
                                       {"turbo", machine.turbo},
                                       {"smt", machine.smt},
                                       {"virtual_machine", machine.virtual_machine},
                                       {"huge_pages", machine.huge_pages},
                                       {"load", fmt::format("{:.2f}", machine.load)},
                                       {"threads", std::to_string(plan.threads)},
                                       {"seed", std::to_string(plan.seed)},
                                       {"repetitions", std::to_string(plan.repetitions)},
                                       {"command", command}};
  for (const auto& [name, version] : build.libraries) p["library " + name] = version;
  for (auto& [name, text] : p) {
    if (text.empty()) text = "unknown";
  }
  return p;
}

std::string command_line() {
  std::ifstream stream("/proc/self/cmdline", std::ios::binary);
  std::string line;
  for (std::string word; std::getline(stream, word, '\0');) {
    const bool plain = !word.empty() && word.find_first_of(" \t\n\"'\\$`*?[]{}()<>|&;!~#") == std::string::npos;
    std::string quoted = plain ? word : "'";
    for (const char c : plain ? std::string{} : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!plain) quoted += '\'';
    // Where the executable lies is this machine's own affair.
    if (line.empty()) quoted = std::filesystem::path(word).filename().string();
    line += (line.empty() ? "" : " ") + quoted;
  }
  return line;
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace raystudy
