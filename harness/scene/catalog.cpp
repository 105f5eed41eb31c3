#include "harness/scene/catalog.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace raystudy {
namespace {

namespace fs = std::filesystem;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

const CatalogEntry* Catalog::find(std::string_view name) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [name](const CatalogEntry& e) { return e.name == name; });
  return found == entries.end() ? nullptr : &*found;
}

fs::path catalog_path() {
  if (const std::string file = variable("RAYSTUDY_CATALOG"); !file.empty()) return file;
  if (fs::path file = RAYSTUDY_SOURCE_CATALOG; fs::exists(file)) return file;
  return RAYSTUDY_INSTALLED_CATALOG;
}

std::optional<fs::path> user_cache() {
  if (const std::string cache = variable("XDG_CACHE_HOME"); !cache.empty()) return fs::path(cache) / "raystudy";
  if (const std::string home = variable("HOME"); !home.empty()) return fs::path(home) / ".cache/raystudy";
  return std::nullopt;
}

std::vector<fs::path> scene_folders() {
  std::vector<fs::path> folders;
  const std::string list = variable("RAYSTUDY_SCENES");
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(':', begin), list.size());
    if (end > begin) folders.emplace_back(list.substr(begin, end - begin));
    begin = end + 1;
  }
  if (const auto cache = user_cache()) folders.push_back(*cache / "scenes");
  return folders;
}

std::optional<fs::path> find_file(const CatalogFile& file) {
  for (const fs::path& folder : scene_folders()) {
    std::error_code ignored;
    for (fs::path p = folder / file.path; p != folder && !p.empty(); p = p.parent_path()) {
      if (fs::is_regular_file(p, ignored)) return folder / file.path;
    }
  }
  return std::nullopt;
}

const CatalogFile* installed_file(const CatalogEntry& entry) {
  for (const CatalogFile& file : entry.files) {
    if (find_file(file)) return &file;
  }
  return nullptr;
}

bool is_installed(const CatalogEntry& entry) {
  return installed_file(entry) != nullptr &&
         std::all_of(entry.frames.begin(), entry.frames.end(), [](const CatalogFile& f) { return find_file(f).has_value(); });
}

}  // namespace raystudy
