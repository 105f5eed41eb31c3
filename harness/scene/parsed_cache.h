#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/scene.h"

namespace raystudy {

/// Raised with every change of what a reader makes of a file: older cache files are then not found.
inline constexpr int reader_version = 2;

/// A file that a model refers to, e.g. its material library, and its XXH3-128; empty where there was none.
struct Sibling {
  std::string relative;
  std::string hash;
};

/// A parsed scene, the SHA-256 of the files it came from and the other files it depends on.
struct ParsedScene {
  Scene scene;
  std::vector<std::string> sha256;
  std::vector<Sibling> siblings;
};

/// The parsed scene of that key, its arrays mapped from `<user cache>/parsed/<key>.scene`; nothing where there is none or a
/// sibling of `model` changed. A damaged file is reported on the error stream, removed and counts as none.
[[nodiscard]] std::optional<ParsedScene> find_parsed(std::string_view key, const std::filesystem::path& model);

/// Writes the cache file atomically. Where that fails (no folder, no rights, a full disk) the error stream says so, once a
/// process.
void keep_parsed(std::string_view key, const ParsedScene& parsed);

}  // namespace raystudy
