#include "harness/scene/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "harness/base/missing_path.h"
#include "harness/scene/archive.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string extension_of(std::string_view name) {
  std::string extension = lower(fs::path(name).extension().string());
  return extension.empty() ? extension : extension.substr(1);
}

/// A file's bytes with every compression taken off, and the name that is left.
struct Unpacked {
  std::string name;   ///< full, with the compression suffixes, for messages
  std::string plain;  ///< without them
  Bytes bytes;
};

Unpacked unpacked(std::string name, Bytes bytes) {
  Unpacked file{name, std::move(name), std::move(bytes)};
  while (is_compression(extension_of(file.plain))) {
    file.bytes = unpack_stream(file.bytes, file.name);
    file.plain = fs::path(file.plain).replace_extension().string();
  }
  return file;
}

/// What `relative` means beside `file`, both inside one archive or one folder.
std::string beside(std::string_view file, std::string_view relative) {
  std::string forward(relative);
  std::replace(forward.begin(), forward.end(), '\\', '/');
  return (fs::path(file).parent_path() / forward).lexically_normal().string();
}

SourceFile finished(const Unpacked& file, bool in_archive, std::function<std::optional<Bytes>(std::string_view)> sibling) {
  return {file.name, fs::path(file.plain).stem().string(), extension_of(file.plain), file.bytes, in_archive, std::move(sibling)};
}

std::string sole_model(const std::vector<std::string>& entries, std::string_view archive) {
  std::vector<std::string> models;
  for (const std::string& entry : entries) {
    std::string plain = entry;
    while (is_compression(extension_of(plain))) plain = fs::path(plain).replace_extension().string();
    const auto& known = known_extensions();
    if (std::find(known.begin(), known.end(), extension_of(plain)) != known.end()) models.push_back(entry);
  }
  if (models.size() == 1) return models.front();
  if (models.empty()) fail_at(archive, "the archive holds no file of a known scene format");
  fail_at(archive, fmt::format("the archive holds {} scene files", models.size()),
          fmt::format("{}/FILE with FILE one of {}", archive, fmt::join(models, ", ")));
}

SourceFile open_in_archive(const Unpacked& archive, std::string inner) {
  const std::vector<std::string> entries = list_archived(archive.bytes, archive.name);
  if (inner.empty()) inner = sole_model(entries, archive.name);
  for (const std::string& entry : entries) {
    if (inner != entry && !(inner.starts_with(entry) && inner[entry.size()] == '/')) continue;
    Unpacked file = unpacked(archive.name + '/' + entry, *read_archived(archive.bytes, archive.name, entry));
    const std::string rest = inner == entry ? "" : inner.substr(entry.size() + 1);
    if (!rest.empty() || is_archive(extension_of(file.plain))) return open_in_archive(file, rest);
    return finished(file, true, [archive, entry](std::string_view relative) {
      return read_archived(archive.bytes, archive.name, beside(entry, relative));
    });
  }
  throw Error(
      Diagnostic{{archive.name, 0, 0}, fmt::format("the archive holds no '{}'", inner), {}, nearest_name(inner, entries)});
}

}  // namespace

fs::path file_on_disk(const fs::path& path) {
  std::error_code ignored;
  for (fs::path p = path; !p.empty(); p = p.parent_path()) {
    if (fs::is_regular_file(p, ignored)) return p;
    if (p == p.parent_path() || fs::exists(p, ignored)) break;
  }
  if (fs::exists(path, ignored)) fail_at(path.string(), "is not a regular file");
  const MissingPath missing = look_around(path);
  throw Error(Diagnostic{
      {path.string(), 0, 0},
      missing.absent_folder.empty() ? "there is no such file" : fmt::format("there is no folder '{}'", missing.absent_folder),
      {},
      missing.nearest});
}

SourceFile open_source(const fs::path& path) {
  const fs::path disk = file_on_disk(path);
  const std::string inner = disk == path ? "" : path.string().substr(disk.string().size() + 1);
  const Unpacked file = unpacked(disk.string(), map_file(disk));
  if (!inner.empty() || is_archive(extension_of(file.plain))) return open_in_archive(file, inner);
  return finished(file, false, [disk](std::string_view relative) { return file_beside(disk, relative); });
}

std::optional<Bytes> file_beside(const fs::path& file, std::string_view relative) {
  const fs::path other = beside(file.string(), relative);
  std::error_code ignored;
  if (!fs::is_regular_file(other, ignored)) return std::nullopt;
  return map_file(other);
}

namespace {

const std::vector<std::pair<std::string, Reader>>& readers() {
  static const std::vector<std::pair<std::string, Reader>> all = [] {
    std::vector<std::pair<std::string, Reader>> list{{"ply", read_ply},  {"obj", read_obj}, {"stl", read_stl},
                                                     {"off", read_off},  {"bsp", read_bsp}, {"gltf", read_gltf},
                                                     {"glb", read_gltf}, {"aff", read_aff}};
    const std::size_t own = list.size();
    for (const std::string& extension : assimp_extensions()) {
      const bool known = std::any_of(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(own),
                                     [&](const auto& r) { return r.first == extension; });
      if (!known && !is_archive(extension)) list.emplace_back(extension, read_assimp);
    }
    return list;
  }();
  return all;
}

}  // namespace

const std::vector<std::string>& known_extensions() {
  static const std::vector<std::string> all = [] {
    std::vector<std::string> names;
    for (const auto& [extension, reader] : readers()) names.push_back(extension);
    return names;
  }();
  return all;
}

Reader reader_for(const SourceFile& source) {
  for (const auto& [extension, reader] : readers()) {
    if (extension == source.extension) return reader;
  }
  throw Error(Diagnostic{{source.name, 0, 0},
                         fmt::format("no reader knows the extension '{}'", source.extension),
                         fmt::format("one of {}", fmt::join(known_extensions(), ", ")),
                         nearest_name(source.extension, known_extensions())});
}

}  // namespace raystudy
