#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/bytes.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// One model file, unpacked, with access to the files it refers to.
struct SourceFile {
  std::string name;       ///< as shown in messages: the path, through archives
  std::string stem;       ///< the file name without extensions, e.g. "oa_dm5"
  std::string extension;  ///< lower case without dot or compression suffix, e.g. "ply"
  Bytes bytes;
  bool in_archive = false;
  /// The file at `relative` to the model's folder (on disk or in the archive), unpacked; nothing where there is none.
  std::function<std::optional<Bytes>(std::string_view relative)> sibling;
};

/// Opens a file, a compressed file (.gz .xz .zst .bz2) or a file inside archives (`a.zip/b.pk3/maps/c.bsp`). An archive that
/// holds exactly one file with a known extension may be named alone. Throws Error.
[[nodiscard]] SourceFile open_source(const std::filesystem::path& path);

/// The part of `path` that is a file on disk: the archive, or the path itself. Throws Error where there is none.
[[nodiscard]] std::filesystem::path file_on_disk(const std::filesystem::path& path);

/// The file at `relative` to the folder of `file`, both on disk; nothing where there is none.
[[nodiscard]] std::optional<Bytes> file_beside(const std::filesystem::path& file, std::string_view relative);

/// Reads one format into an unfinished scene: arrays, materials, lights and cameras, not yet checked by finish_scene.
using Reader = Scene (*)(const SourceFile&);
/// By extension; throws Error with the nearest known one.
[[nodiscard]] Reader reader_for(const SourceFile& source);
[[nodiscard]] const std::vector<std::string>& known_extensions();

Scene read_aff(const SourceFile& source);
Scene read_bsp(const SourceFile& source);
Scene read_gltf(const SourceFile& source);
Scene read_obj(const SourceFile& source);
Scene read_off(const SourceFile& source);
Scene read_ply(const SourceFile& source);
Scene read_stl(const SourceFile& source);
/// Formats that have no reader of their own.
Scene read_assimp(const SourceFile& source);
[[nodiscard]] const std::vector<std::string>& assimp_extensions();

}  // namespace raystudy
