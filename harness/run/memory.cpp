#include "harness/run/memory.h"

#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace raystudy {
namespace {

/// A line `key: NUMBER kB` of a file of /proc, in bytes; 0 where it is not there.
double proc_bytes(const char* file, const std::string& key) {
  std::ifstream stream(file);
  std::string word;
  while (stream >> word) {
    double kilobytes = 0;
    if (word == key + ':' && stream >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

double mapped_bytes() {
  std::ifstream stream("/proc/self/statm");
  double pages = 0;
  stream >> pages;
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  std::ofstream marks("/proc/self/clear_refs");
  marks << "5" << std::flush;
  works_ = marks.good();
  before_ = proc_bytes("/proc/self/status", "VmHWM");
}

std::optional<double> PeakMemory::bytes() const {
  if (!works_) return std::nullopt;
  return proc_bytes("/proc/self/status", "VmHWM") - before_;
}

MemoryLimit::MemoryLimit(double bytes) {
  if (bytes <= 0 || !is_enforced()) return;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  before_ = limit.rlim_cur;
  limit.rlim_cur = std::min(before_, static_cast<rlim_t>(mapped_bytes() + bytes));
  set_ = setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  if (!set_) return;
  rlimit limit{};
  getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = before_;
  setrlimit(RLIMIT_AS, &limit);
}

bool MemoryLimit::is_enforced() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;
#else
  return true;
#endif
}

double available_memory() { return proc_bytes("/proc/meminfo", "MemAvailable"); }

}  // namespace raystudy
