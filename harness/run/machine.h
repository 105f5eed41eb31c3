#pragma once

#include <string>
#include <vector>

namespace raystudy {

/// What of this machine can change a timing. Texts are empty where the system does not tell.
struct Machine {
  std::string cpu;              ///< model name
  std::string microcode;        ///< revision
  int cores = 0;                ///< logical processors this process may use
  std::string kernel;           ///< release
  std::string governor;         ///< of the first processor, e.g. performance
  std::string turbo;            ///< on, off
  std::string smt;              ///< on, off
  std::string virtual_machine;  ///< yes, no
  std::string huge_pages;       ///< transparent huge pages: always, madvise, never
  double memory = 0;            ///< bytes
  double available_memory = 0;  ///< bytes
  double swap_used = 0;         ///< bytes
  std::string clock;            ///< clock source, e.g. tsc
  double load = 0;              ///< mean number of running processes over the last minute
};

/// A process that takes processor time from others.
struct BusyProcess {
  int pid = 0;
  std::string name;
  double processors = 0;  ///< 1: one whole processor
};

/// Those that took a tenth of a processor or more over `seconds`, without this process, busiest first.
[[nodiscard]] std::vector<BusyProcess> busy_processes(double seconds);

/// Reads /proc and /sys below `root` (empty: the machine's own).
[[nodiscard]] Machine read_machine(const std::string& root = {});

}  // namespace raystudy
