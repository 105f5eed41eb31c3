#pragma once

#include <sys/resource.h>

#include <optional>

namespace raystudy {

/// The most memory this process holds from now on, above what it holds now: the kernel's high-water mark of resident memory, set
/// back at the start (proc(5), clear_refs). Memory that the C library keeps for reuse is given back to the kernel first, so that
/// it counts anew. One at a time in a process.
class PeakMemory {
 public:
  PeakMemory();
  /// Bytes; nothing where the kernel does not allow the mark to be set back.
  [[nodiscard]] std::optional<double> bytes() const;

 private:
  double before_ = 0;
  bool works_ = false;
};

/// While it lives, the process may not map more than `bytes` above what it has mapped: allocations beyond throw std::bad_alloc.
/// 0: no limit.
class MemoryLimit {
 public:
  explicit MemoryLimit(double bytes);
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;
  ~MemoryLimit();

  /// False under a sanitizer, whose own memory and allocator make a limit meaningless.
  [[nodiscard]] static bool is_enforced();

 private:
  rlim_t before_ = 0;
  bool set_ = false;
};

/// Memory that could be given to programs now without swapping, in bytes (MemAvailable).
[[nodiscard]] double available_memory();

}  // namespace raystudy
