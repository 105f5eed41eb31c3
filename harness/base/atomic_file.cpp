#include "harness/base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <optional>
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

std::string temporary_name(const std::filesystem::path& target) {
  return fmt::format(".{}.{}.tmp", target.filename().string(), getpid());
}

/// The process that a name of `temporary_name`'s form speaks of.
std::optional<pid_t> writer_of(std::string_view name) {
  constexpr std::string_view end = ".tmp";
  if (!name.starts_with('.') || !name.ends_with(end)) return std::nullopt;
  name.remove_suffix(end.size());
  const std::string_view digits = name.substr(name.rfind('.') + 1);
  pid_t pid = 0;
  const auto [stop, code] = std::from_chars(digits.data(), digits.data() + digits.size(), pid);
  const bool whole = code == std::errc{} && stop == digits.data() + digits.size();
  return whole && pid > 0 ? std::optional(pid) : std::nullopt;
}

/// A file that exists only until it is renamed: the destructor removes what `commit` did not put in place.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target)
      : target_(target), path_(target.parent_path() / temporary_name(target)) {
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

  void commit(Durable durable) {
    if (durable == Durable::yes && fsync(file_) != 0) fail(target_, "cannot write", errno);
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

void write_file_atomically(const std::filesystem::path& file, std::string_view content, Durable durable) {
  write_file_atomically(file, std::span(&content, 1), durable);
}

void write_file_atomically(const std::filesystem::path& file, std::span<const std::string_view> parts, Durable durable) {
  const std::filesystem::path folder = folder_of(file);
  make_folder(folder);
  TemporaryFile temporary(file);
  for (const std::string_view part : parts) temporary.write(part);
  temporary.commit(durable);
}

void remove_stale_temporaries(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const auto now = fs::file_time_type::clock::now();
  std::error_code ignored;
  for (fs::recursive_directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const std::optional<pid_t> pid = writer_of(at->path().filename().native());
    if (!pid || !at->is_regular_file(ignored)) continue;
    const bool is_gone = kill(*pid, 0) != 0 && errno == ESRCH;
    const fs::file_time_type written = at->last_write_time(ignored);
    if (is_gone && !ignored && now - written > std::chrono::minutes(1)) fs::remove(at->path(), ignored);
  }
}

void require_writable_folder(const std::filesystem::path& folder) {
  make_folder(folder);
  const std::filesystem::path probe = folder / temporary_name("writable");
  const int file = open(probe.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) fail(folder, "cannot write into the folder", errno);
  const bool has_room = ::write(file, "x", 1) == 1 && fsync(file) == 0;
  const int code = errno;
  close(file);
  unlink(probe.c_str());
  if (!has_room) fail(folder, "cannot write into the folder", code);
}

}  // namespace raystudy
