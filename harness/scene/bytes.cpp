#include "harness/scene/bytes.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <memory>

namespace raystudy {
namespace {

struct Descriptor {
  int fd;
  explicit Descriptor(int fd_) : fd(fd_) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

}  // namespace

Bytes to_bytes(std::string text) {
  auto owned = std::make_shared<const std::string>(std::move(text));
  const std::span<const char> view(owned->data(), owned->size());
  return {std::move(owned), view};
}

Bytes map_file(const std::filesystem::path& file) {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (opened.fd < 0 || ::fstat(opened.fd, &status) != 0) {
    fail_at(file.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  }
  if (!S_ISREG(status.st_mode)) fail_at(file.string(), "is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return {};
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, opened.fd, 0);
  if (address == MAP_FAILED) fail_at(file.string(), fmt::format("cannot be mapped: {}", std::strerror(errno)));
  std::shared_ptr<const void> keep(address, [size](const void* p) { ::munmap(const_cast<void*>(p), size); });
  return {std::move(keep), {static_cast<const char*>(address), size}};
}

std::string xxh3_hex(std::string_view data) {
  const XXH128_hash_t hash = XXH3_128bits(data.data(), data.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace raystudy
