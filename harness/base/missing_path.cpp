#include "harness/base/missing_path.h"

#include <algorithm>
#include <system_error>

#include "harness/base/error.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

/// `path` with its last name replaced by the nearest one in its folder that `is_candidate`; empty where none is near.
template <class IsCandidate>
std::string nearest_in_folder(const fs::path& path, IsCandidate is_candidate) {
  const fs::path folder = path.parent_path();
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    if (is_candidate(entry)) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());  // a folder lists its names in no order, and the first of two equally near is taken
  const std::string name = nearest_name(path.filename().string(), names);
  return name.empty() ? "" : (folder / name).string();
}

}  // namespace

MissingPath look_around(const fs::path& path, const std::vector<std::string_view>& extensions) {
  std::error_code ignored;
  fs::path absent;
  for (fs::path folder = path.parent_path(); !folder.empty() && !fs::exists(folder, ignored); folder = folder.parent_path()) {
    absent = folder;
  }
  if (!absent.empty()) {
    return {absent.string(),
            nearest_in_folder(absent, [&](const fs::directory_entry& entry) { return entry.is_directory(ignored); })};
  }
  return {{}, nearest_in_folder(path, [&](const fs::directory_entry& entry) {
            const std::string extension = entry.path().extension().string();
            return entry.is_regular_file(ignored) &&
                   (extensions.empty() || std::find(extensions.begin(), extensions.end(), extension) != extensions.end());
          })};
}

}  // namespace raystudy
