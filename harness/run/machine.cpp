#include "harness/run/machine.h"

#include <sched.h>

#include <fstream>
#include <sstream>

namespace raystudy {
namespace {

std::string first_line(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

/// The value of the first `key : value` line of a file.
std::string field(const std::string& file, const std::string& key) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::string name = line.substr(0, line.find_last_not_of(" \t", colon - 1) + 1);
    if (name != key) continue;
    const std::size_t start = line.find_first_not_of(" \t", colon + 1);
    return start == std::string::npos ? std::string{} : line.substr(start);
  }
  return {};
}

double kilobytes(const std::string& file, const std::string& key) {
  std::istringstream stream(field(file, key));
  double value = 0;
  stream >> value;
  return value * 1024;
}

/// `always [madvise] never` → madvise.
std::string chosen(const std::string& line) {
  const std::size_t open = line.find('[');
  const std::size_t close = line.find(']');
  return open == std::string::npos || close == std::string::npos ? std::string{} : line.substr(open + 1, close - open - 1);
}

std::string turbo_state(const std::string& root) {
  // intel_pstate says whether turbo is off, other drivers whether boost is on.
  if (const std::string off = first_line(root + "/sys/devices/system/cpu/intel_pstate/no_turbo"); !off.empty()) {
    return off == "0" ? "on" : "off";
  }
  const std::string boost = first_line(root + "/sys/devices/system/cpu/cpufreq/boost");
  return boost.empty() ? std::string{} : boost == "1" ? "on" : "off";
}

int usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
}

}  // namespace

Machine read_machine(const std::string& root) {
  const std::string cpuinfo = root + "/proc/cpuinfo";
  const std::string meminfo = root + "/proc/meminfo";
  Machine m;
  m.cpu = field(cpuinfo, "model name");
  m.microcode = field(cpuinfo, "microcode");
  m.cores = usable_cores();
  m.kernel = first_line(root + "/proc/sys/kernel/osrelease");
  m.governor = first_line(root + "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  m.turbo = turbo_state(root);
  if (const std::string smt = first_line(root + "/sys/devices/system/cpu/smt/active"); !smt.empty())
    m.smt = smt == "1" ? "on" : "off";
  if (const std::string flags = field(cpuinfo, "flags"); !flags.empty()) {
    m.virtual_machine = (" " + flags + " ").find(" hypervisor ") != std::string::npos ? "yes" : "no";
  }
  m.huge_pages = chosen(first_line(root + "/sys/kernel/mm/transparent_hugepage/enabled"));
  m.memory = kilobytes(meminfo, "MemTotal");
  m.available_memory = kilobytes(meminfo, "MemAvailable");
  m.swap_used = kilobytes(meminfo, "SwapTotal") - kilobytes(meminfo, "SwapFree");
  std::istringstream(first_line(root + "/proc/loadavg")) >> m.load;
  return m;
}

}  // namespace raystudy
