#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "harness/base/error.h"
#include "harness/base/missing_path.h"
#include "harness/method/registry.h"

namespace raystudy {
namespace {

std::vector<std::filesystem::path> plugin_files(const std::filesystem::path& path) {
  if (std::filesystem::is_regular_file(path)) return {path};
  if (!std::filesystem::is_directory(path)) {
    const MissingPath missing = look_around(path, {".so"});
    throw Error(Diagnostic{{},
                           fmt::format("RAYSTUDY_PLUGINS names '{}', which is not there{}", path.string(),
                                       missing.absent_folder.empty() ? "" : fmt::format(", nor is '{}'", missing.absent_folder)),
                           "a shared library, or a folder of them",
                           missing.nearest});
  }
  std::vector<std::filesystem::path> files;
  for (const auto& item : std::filesystem::directory_iterator(path)) {
    if (item.path().extension() == ".so") files.push_back(item.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    throw Error(Diagnostic{{},
                           fmt::format("RAYSTUDY_PLUGINS names the folder '{}', which holds no *.so", path.string()),
                           "a shared library, or a folder of them",
                           {}});
  }
  return files;
}

void load_plugin(const std::filesystem::path& file) {
  Registry& registry = Registry::instance();
  const std::size_t before = registry.entries().size();
  registry.set_origin(file.string());
  // Never closed: the registry keeps functions of the library until the program ends.
  void* handle = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  registry.set_origin("built in");
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw Error(
        Diagnostic{{},
                   fmt::format("cannot load plugin '{}': {}", file.string(), reason != nullptr ? reason : "unknown reason"),
                   "a shared library built with find_package(Raystudy) of this version",
                   {}});
  }
  registry.require_no_conflicts();
  if (registry.entries().size() == before) {
    throw Error(Diagnostic{{},
                           fmt::format("plugin '{}' registers no method", file.string()),
                           "a static raystudy::Registration<T> object in it",
                           {}});
  }
}

}  // namespace

void load_plugins(std::string_view paths) {
  while (!paths.empty()) {
    const std::size_t colon = std::min(paths.find(':'), paths.size());
    if (const std::string_view path = paths.substr(0, colon); !path.empty()) {
      for (const auto& file : plugin_files(path)) load_plugin(file);
    }
    paths.remove_prefix(std::min(colon + 1, paths.size()));
  }
}

}  // namespace raystudy
