#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
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

/// Room for elements of a fixed number, not written to before they are.
template <class T>
class AlignedRoom {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  explicit AlignedRoom(std::size_t n) : size_(n), data_(AlignedAllocator<T>().allocate(n)) {}
  AlignedRoom(const AlignedRoom&) = delete;
  AlignedRoom& operator=(const AlignedRoom&) = delete;
  ~AlignedRoom() { AlignedAllocator<T>().deallocate(data_, size_); }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] T& operator[](std::size_t i) { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }

 private:
  std::size_t size_;
  T* data_;
};

}  // namespace raystudy
