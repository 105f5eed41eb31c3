#include "harness/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "harness/base/error.h"

namespace raystudy {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, std::string_view what, int code) {
  throw Error(Diagnostic{{path.string()}, fmt::format("{}: {}", what, std::generic_category().message(code)), {}, {}});
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code code;
  std::filesystem::create_directories(folder, code);
  if (code) fail(folder, "cannot make the folder", code.value());
}

/// A file that exists only until it is renamed: the destructor removes what `commit` did not put in place.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(target), path_(target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), getpid())) {
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file_ < 0) fail(target_, "cannot write", errno);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (file_ >= 0) close(file_);
    if (!committed_) unlink(path_.c_str());
  }

  void write(std::string_view content) {
    while (!content.empty()) {
      const ssize_t written = ::write(file_, content.data(), content.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) fail(target_, "cannot write", errno);
      content.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void commit() {
    if (fsync(file_) != 0) fail(target_, "cannot write", errno);
    const int result = close(file_);
    file_ = -1;
    if (result != 0) fail(target_, "cannot write", errno);
    if (rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "cannot write", errno);
    committed_ = true;
  }

 private:
  std::filesystem::path target_;
  std::filesystem::path path_;
  int file_ = -1;
  bool committed_ = false;
};

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

}  // namespace

void write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  const std::filesystem::path folder = folder_of(file);
  make_folder(folder);
  TemporaryFile temporary(file);
  temporary.write(content);
  temporary.commit();
}

void require_writable_folder(const std::filesystem::path& folder) {
  make_folder(folder);
  const std::filesystem::path probe = folder / fmt::format(".writable.{}.tmp", getpid());
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(folder, "cannot write into the folder", errno);
  const bool has_room = ::write(file, "x", 1) == 1 && fsync(file) == 0;
  const int code = errno;
  close(file);
  unlink(probe.c_str());
  if (!has_room) fail(folder, "cannot write into the folder", code);
}

}  // namespace raystudy
