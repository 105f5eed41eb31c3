#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/catalog.h"

namespace raystudy {

/// A `get` of the catalog, taken apart: https://…, npm:package@version#path or deb:package#path.
struct FetchSource {
  enum class Kind : unsigned char { https, npm, deb };
  Kind kind = Kind::https;
  std::string from;  ///< the address, or the package
  std::string path;  ///< inside the package, through archives in it; empty for https
};
/// Throws Error for what is none of the three.
[[nodiscard]] FetchSource parse_source(std::string_view get);

/// Fetches a file with the ordinary client (libcurl, `npm pack`, `apt-get download`), compares its SHA-256, and puts it in place
/// below `folder` with one rename. Whatever goes wrong (no client, no network, a download cut short, a wrong hash, a full disk)
/// throws Error with the reason and leaves nothing behind. Progress goes to the error stream. Returns the file's path.
std::filesystem::path fetch_file(const CatalogFile& file, const std::filesystem::path& folder);

/// Downloads an address into `to`. `protocols` as libcurl's CURLOPT_PROTOCOLS_STR. Throws Error.
void download(const std::string& address, const std::filesystem::path& to, const char* protocols = "https");

/// Fetches what an entry lacks into the user's cache: its model and frames. Returns the paths of new files, none where all was at
/// hand. Throws SceneNotInstalled where the catalog knows no source.
std::vector<std::filesystem::path> get_scene(const CatalogEntry& entry);

}  // namespace raystudy
