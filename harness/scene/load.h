#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "harness/base/error.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// A file to read, and what it must be.
struct FileToRead {
  std::filesystem::path path;     ///< may lead into an archive
  std::string sha256 = {};        ///< of the file on disk; empty: not checked
  SourceLocation described = {};  ///< where the hash stands
};

/// Reads a model and its frames (`.f32` sequences or models of the same topology), by way of the parsed-scene cache. Hashes are
/// compared when the files are parsed; a cached scene is found by the files' content, so that it was compared then. Throws Error.
[[nodiscard]] Scene load_scene(const FileToRead& model, const std::vector<FileToRead>& frames = {});

}  // namespace raystudy
