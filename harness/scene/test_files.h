#pragma once

#include <archive.h>
#include <archive_entry.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/support/files.h"

namespace raystudy::test {

/// An environment variable for the length of a test; nullopt unsets it.
class ScopedVariable {
 public:
  ScopedVariable(std::string name, const std::optional<std::string>& value) : name_(std::move(name)) {
    if (const char* old = std::getenv(name_.c_str())) old_ = old;
    set(value);
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;
  ~ScopedVariable() { set(old_); }

 private:
  void set(const std::optional<std::string>& value) {
    if (value) {
      ::setenv(name_.c_str(), value->c_str(), 1);
    } else {
      ::unsetenv(name_.c_str());
    }
  }
  std::string name_;
  std::optional<std::string> old_;
};

/// A cache of its own and no scenes folder.
struct CleanEnvironment {
  TempFolder folder;
  ScopedVariable cache{"XDG_CACHE_HOME", (folder.path() / "cache").string()};
  ScopedVariable scenes{"RAYSTUDY_SCENES", std::nullopt};
};

template <class... T>
std::string packed(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

template <class... T>
std::string packed_big_endian(T... values) {
  std::string bytes;
  const auto add = [&bytes](auto value) {
    std::string one = packed(value);
    bytes.append(one.rbegin(), one.rend());
  };
  (add(values), ...);
  return bytes;
}

inline std::string written(const std::function<void(archive*)>& set_up,
                           const std::vector<std::pair<std::string, std::string>>& files) {
  archive* a = archive_write_new();
  set_up(a);
  std::size_t bytes = 1 << 20U;
  for (const auto& [name, content] : files) bytes += 2 * content.size();
  std::string out(bytes, '\0');
  std::size_t used = 0;
  archive_write_set_bytes_per_block(a, 0);
  archive_write_open_memory(a, out.data(), out.size(), &used);
  for (const auto& [name, content] : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(content.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(a, entry);
    archive_write_data(a, content.data(), content.size());
    archive_entry_free(entry);
  }
  archive_write_close(a);
  archive_write_free(a);
  out.resize(used);
  return out;
}

inline std::string compressed(std::string_view content, int (*filter)(archive*)) {
  return written(
      [filter](archive* a) {
        filter(a);
        archive_write_set_format_raw(a);
      },
      {{"data", std::string(content)}});
}

inline std::string zipped(const std::vector<std::pair<std::string, std::string>>& files) {
  return written([](archive* a) { archive_write_set_format_zip(a); }, files);
}

inline std::string tarred(const std::vector<std::pair<std::string, std::string>>& files) {
  return written(
      [](archive* a) {
        archive_write_add_filter_gzip(a);
        archive_write_set_format_ustar(a);
      },
      files);
}

/// A unit square of two triangles: vertices (0,0,0), (1,0,0), (1,1,0), (0,1,0).
inline constexpr std::string_view square_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

}  // namespace raystudy::test
