#include "harness/scene/fetch.h"

#include <curl/curl.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <memory>

#include "harness/base/atomic_file.h"
#include "harness/base/progress.h"
#include "harness/scene/archive.h"
#include "harness/scene/open.h"
#include "harness/scene/sha256.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

// Work folders are named .get-<pid>-XXXXXX: one whose process is gone was left by a kill or a power cut.
void remove_stale(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    constexpr std::string_view prefix = ".get-";
    pid_t pid = 0;
    if (!name.starts_with(prefix) ||
        std::from_chars(name.data() + prefix.size(), name.data() + name.size(), pid).ec != std::errc{}) {
      continue;
    }
    if (pid > 0 && ::kill(pid, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
  }
}

/// A folder beside the final place, so that the rename stays within one file system; gone with the object.
class WorkFolder {
 public:
  explicit WorkFolder(const fs::path& folder) {
    require_writable_folder(folder);
    remove_stale(folder);
    std::string name = (folder / fmt::format(".get-{}-XXXXXX", ::getpid())).string();
    if (::mkdtemp(name.data()) == nullptr) {
      fail_at(folder.string(), fmt::format("no folder can be made in it: {}", std::strerror(errno)));
    }
    path_ = name;
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// The last lines a client printed, for its error message.
std::string tail_of(const fs::path& log) {
  std::error_code ignored;
  if (fs::file_size(log, ignored) == 0 || ignored) return "it said nothing";
  const Bytes bytes = map_file(log);
  std::string_view text = as_text(bytes);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  std::size_t begin = text.size();
  for (int lines = 0; lines < 3 && begin != std::string_view::npos && begin > 0; ++lines) begin = text.rfind('\n', begin - 1);
  std::string tail(begin == std::string_view::npos ? text : text.substr(begin));
  if (tail.starts_with('\n')) tail.erase(0, 1);
  return tail;
}

/// Runs a client in `folder`, its output kept aside. Throws Error where it is missing or fails.
void run_client(const std::vector<std::string>& command, const std::string& debian_package, const fs::path& folder) {
  const fs::path log = folder / "log";
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT: the interface is C's
  arguments.push_back(nullptr);
  pid_t pid = 0;
  const int failed = posix_spawnp(&pid, command[0].c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed == ENOENT) {
    throw Error(Diagnostic{{},
                           fmt::format("the client '{}' is not on the PATH", command[0]),
                           fmt::format("the Debian package {}", debian_package),
                           {}});
  }
  if (failed != 0) throw Error(fmt::format("the client '{}' cannot be started: {}", command[0], std::strerror(failed)));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) throw Error(fmt::format("'{}' failed: {}", fmt::join(command, " "), tail_of(log)));
}

fs::path sole_file(const fs::path& folder, std::string_view extension) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == extension) return entry.path();
  }
  throw Error(Diagnostic{{folder.string(), 0, 0}, "the client left no package", fmt::format("a file *{}", extension), {}});
}

Bytes fetch_npm(const FetchSource& source, const fs::path& work) {
  run_client({"npm", "pack", "--ignore-scripts", source.from}, "npm", work);
  const fs::path package = sole_file(work, ".tgz");
  return read_inside(map_file(package), source.from, "package/" + source.path);
}

Bytes fetch_deb(const FetchSource& source, const fs::path& work) {
  run_client({"apt-get", "download", source.from}, "apt", work);
  const Bytes package = map_file(sole_file(work, ".deb"));
  for (const std::string& entry : list_archived(package, source.from)) {
    if (entry.starts_with("data.tar")) return read_inside(package, source.from, entry + '/' + source.path);
  }
  throw Error(Diagnostic{{source.from, 0, 0}, "the Debian package holds no data", "data.tar.*", {}});
}

Bytes fetch(const FetchSource& source, const fs::path& work) {
  if (source.kind == FetchSource::Kind::npm) return fetch_npm(source, work);
  if (source.kind == FetchSource::Kind::deb) return fetch_deb(source, work);
  download(source.from, work / "file");
  return map_file(work / "file");
}

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

int report(void* progress, curl_off_t total, curl_off_t now, curl_off_t /*up_total*/, curl_off_t /*up_now*/) {
  if (total > 0) {
    static_cast<Progress*>(progress)->update(static_cast<double>(now) / static_cast<double>(total),
                                             bytes_text(static_cast<double>(now)));
  }
  return 0;
}

}  // namespace

FetchSource parse_source(std::string_view get) {
  if (get.starts_with("https://")) return {FetchSource::Kind::https, std::string(get), {}};
  const std::size_t hash = get.find('#');
  const bool npm = get.starts_with("npm:");
  if ((npm || get.starts_with("deb:")) && hash != std::string_view::npos && hash > 4 && hash + 1 < get.size()) {
    std::string package(get.substr(4, hash - 4));
    const bool good = package[0] != '-' && (!npm || package.find('@', 1) != std::string::npos);  // @scope/name@version
    if (good) {
      return {npm ? FetchSource::Kind::npm : FetchSource::Kind::deb, std::move(package), std::string(get.substr(hash + 1))};
    }
  }
  throw Error(
      Diagnostic{{}, fmt::format("'{}' is no source", get), "https://…, npm:package@version#path or deb:package#path", {}});
}

void download(const std::string& address, const fs::path& to, const char* protocols) {
  static const bool ready = curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK;
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(ready ? curl_easy_init() : nullptr, curl_easy_cleanup);
  const std::unique_ptr<std::FILE, FileCloser> out(std::fopen(to.c_str(), "wb"));
  if (!curl) throw Error("libcurl cannot be started");
  if (!out) fail_at(to.string(), fmt::format("cannot be written: {}", std::strerror(errno)));
  Progress progress(address, 1, 0.1);
  curl_easy_setopt(curl.get(), CURLOPT_URL, address.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl.get(), CURLOPT_REDIR_PROTOCOLS_STR, protocols);
  curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_FAILONERROR, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  // A server that has stopped sending is a cut download.
  curl_easy_setopt(curl.get(), CURLOPT_CONNECTTIMEOUT, 30L);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_LIMIT, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_TIME, 60L);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, out.get());
  curl_easy_setopt(curl.get(), CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFOFUNCTION, report);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFODATA, &progress);
  const CURLcode code = curl_easy_perform(curl.get());
  const int write_error = std::fflush(out.get()) != 0 ? errno : 0;
  if (code == CURLE_WRITE_ERROR || write_error != 0) {
    fail_at(to.string(), fmt::format("cannot be written: {}", std::strerror(write_error != 0 ? write_error : ENOSPC)));
  }
  if (code == CURLE_PARTIAL_FILE) throw Error(fmt::format("{}: the download was cut short", address));
  long status = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &status);
  if (code == CURLE_HTTP_RETURNED_ERROR) throw Error(fmt::format("{}: the server answered {}", address, status));
  if (code != CURLE_OK) throw Error(fmt::format("{}: {}", address, curl_easy_strerror(code)));
}

fs::path fetch_file(const CatalogFile& file, const fs::path& folder) {
  const FetchSource source = parse_source(file.get);
  const WorkFolder work(folder);
  if (source.kind != FetchSource::Kind::https) fmt::print(stderr, "fetching {}\n", file.get);
  const Bytes bytes = fetch(source, work.path());
  if (const std::string found = sha256_hex(as_text(bytes)); found != file.sha256) {
    fail_at(file.get, fmt::format("the SHA-256 of what came is {}", found),
            fmt::format("{}; nothing was installed", file.sha256));
  }
  fs::path target = folder / file.path;
  write_file_atomically(target, as_text(bytes));
  return target;
}

std::vector<fs::path> get_scene(const CatalogEntry& entry) {
  std::vector<CatalogFile> missing;
  if (installed_file(entry) == nullptr) {
    for (const CatalogFile& file : entry.files) {
      if (!file.get.empty() && missing.empty()) missing.push_back(file);
    }
    if (missing.empty()) throw SceneNotInstalled(not_installed_text(entry));
  }
  for (const CatalogFile& frame : entry.frames) {
    if (find_file(frame)) continue;
    if (frame.get.empty()) throw SceneNotInstalled(not_installed_text(entry));
    missing.push_back(frame);
  }
  std::vector<fs::path> fetched;
  if (missing.empty()) return fetched;
  const auto cache = user_cache();
  if (!cache) throw Error("there is no folder to install scenes in; expected XDG_CACHE_HOME or HOME in the environment");
  for (const CatalogFile& file : missing) fetched.push_back(fetch_file(file, *cache / "scenes"));
  return fetched;
}

}  // namespace raystudy
