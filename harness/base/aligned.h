#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <vector>

namespace raystudy {

/// Which pages a large block of memory is in: huge ones where the system grants them (fewer page faults while building, fewer
/// misses of the address translation while tracing), or normal ones in any case.
enum class Pages : std::uint8_t { huge, normal };

/// Allocates on cache-line boundaries, so that pairs of BVH nodes never straddle two lines; blocks of four megabytes and more on
/// the boundaries of huge pages.
template <class T>
class AlignedAllocator {
 public:
  using value_type = T;
  using is_always_equal = std::true_type;  // any can free what another allocated
  static constexpr std::size_t alignment = 64;

  AlignedAllocator() = default;
  explicit AlignedAllocator(Pages pages) : pages_(pages) {}
  template <class U>
  AlignedAllocator(const AlignedAllocator<U>& other) noexcept  // NOLINT(google-explicit-constructor): allocators must convert
      : pages_(other.pages()), initializes_(other.initializes()) {}

  /// For one vector of elements that are about to be written: those it is made with, AlignedVector<T>(n, uninitialized()), are
  /// not, so that threads can share the first use of the memory.
  [[nodiscard]] static AlignedAllocator uninitialized() {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    AlignedAllocator allocator;
    allocator.initializes_ = false;
    return allocator;
  }

  T* allocate(std::size_t n) {
    void* p = ::operator new(n * sizeof(T), alignment_of(n));
    if (alignment_of(n) == std::align_val_t{huge_page}) advise(p, n * sizeof(T));
    return static_cast<T*>(p);
  }
  void deallocate(T* p, std::size_t n) noexcept { ::operator delete(p, alignment_of(n)); }
  /// What a vector makes elements without a value by.
  template <class U>
  void construct(U* p) {
    if (initializes_) ::new (static_cast<void*>(p)) U();
  }
  [[nodiscard]] Pages pages() const { return pages_; }
  [[nodiscard]] bool initializes() const { return initializes_; }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }

 private:
  static constexpr std::size_t huge_page = std::size_t{1} << 21U;
  static std::align_val_t alignment_of(std::size_t n) {
    return std::align_val_t{n * sizeof(T) >= 2 * huge_page ? huge_page : alignment};
  }

  void advise(void* p, std::size_t bytes) const {
    if (pages_ == Pages::huge) {
      ::madvise(p, bytes, MADV_HUGEPAGE);  // a wish; refusal does no harm
      return;
    }
    // The block may be one that was freed before, huge pages and all: those are dropped, only whole ones that are the block's
    // own.
    const std::size_t whole = bytes - bytes % 4096;
    ::madvise(p, whole, MADV_NOHUGEPAGE);
    ::madvise(p, whole, MADV_DONTNEED);
  }

  Pages pages_ = Pages::huge;
  bool initializes_ = true;
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
