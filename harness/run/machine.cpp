#include "harness/run/machine.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <system_error>
#include <thread>

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

struct ProcessTime {
  std::string name;
  double seconds = 0;  ///< of processor time since it began
};

/// Field 2 of /proc/PID/stat is the name in parentheses (it may hold spaces), 14 and 15 the time in user and kernel mode in
/// ticks.
std::map<int, ProcessTime> process_times() {
  std::map<int, ProcessTime> times;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string line = first_line(entry.path() / "stat");
    const std::size_t open = line.find('(');
    const std::size_t close = line.rfind(')');
    if (open == std::string::npos || close == std::string::npos) continue;  // it has ended meanwhile
    std::istringstream rest(line.substr(close + 1));
    std::string skipped;
    for (int field = 3; field < 14; ++field) rest >> skipped;
    double user = 0;
    double kernel = 0;
    rest >> user >> kernel;
    times[std::stoi(name)] = {line.substr(open + 1, close - open - 1),
                              (user + kernel) / static_cast<double>(sysconf(_SC_CLK_TCK))};
  }
  return times;
}

int usable_cores() {
  cpu_set_t set;
  CPU_ZERO(&set);
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
}

}  // namespace

std::vector<BusyProcess> busy_processes(double seconds) {
  constexpr double worth_telling = 0.1;
  const std::map<int, ProcessTime> before = process_times();
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  std::vector<BusyProcess> busy;
  for (const auto& [pid, now] : process_times()) {
    const auto earlier = before.find(pid);
    if (pid == getpid() || earlier == before.end()) continue;
    const double processors = (now.seconds - earlier->second.seconds) / seconds;
    if (processors >= worth_telling) busy.push_back({pid, now.name, processors});
  }
  std::sort(busy.begin(), busy.end(), [](const BusyProcess& a, const BusyProcess& b) { return a.processors > b.processors; });
  return busy;
}

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
  if (const std::string smt = first_line(root + "/sys/devices/system/cpu/smt/active"); !smt.empty()) {
    m.smt = smt == "1" ? "on" : "off";
  }
  if (const std::string flags = field(cpuinfo, "flags"); !flags.empty()) {
    m.virtual_machine = (" " + flags + " ").find(" hypervisor ") != std::string::npos ? "yes" : "no";
  }
  m.huge_pages = chosen(first_line(root + "/sys/kernel/mm/transparent_hugepage/enabled"));
  m.clock = first_line(root + "/sys/devices/system/clocksource/clocksource0/current_clocksource");
  m.memory = kilobytes(meminfo, "MemTotal");
  m.available_memory = kilobytes(meminfo, "MemAvailable");
  m.swap_used = kilobytes(meminfo, "SwapTotal") - kilobytes(meminfo, "SwapFree");
  std::istringstream(first_line(root + "/proc/loadavg")) >> m.load;
  return m;
}

}  // namespace raystudy
