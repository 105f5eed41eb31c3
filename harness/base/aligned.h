#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace raystudy {

/// Allocates on cache-line boundaries, so that pairs of BVH nodes never straddle two lines. Large blocks are in huge pages where
/// the system grants them: fewer page faults while building, fewer misses of the address translation while tracing.
template <class T>
class AlignedAllocator {
 public:
  using value_type = T;
  static constexpr std::size_t alignment = 64;

  AlignedAllocator() = default;
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor): allocators must convert

  T* allocate(std::size_t n) {
    void* p = ::operator new(n * sizeof(T), alignment_of(n));
    if (alignment_of(n) == std::align_val_t{huge_page}) {
      ::madvise(p, n * sizeof(T), MADV_HUGEPAGE);  // a wish; refusal does no harm
    }
    return static_cast<T*>(p);
  }
  void deallocate(T* p, std::size_t n) noexcept { ::operator delete(p, alignment_of(n)); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }

 private:
  static constexpr std::size_t huge_page = std::size_t{1} << 21U;
  static std::align_val_t alignment_of(std::size_t n) {
    return std::align_val_t{n * sizeof(T) >= 2 * huge_page ? huge_page : alignment};
  }
};

template <class T>
using AlignedVector = std::vector<T, AlignedAllocator<T>>;

}  // namespace raystudy
