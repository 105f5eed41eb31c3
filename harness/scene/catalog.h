#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// A file of a catalog scene.
struct CatalogFile {
  std::string path;    ///< below a scenes folder, e.g. "dragon/dragon_vrip.ply.gz"; may lead into an archive
  std::string sha256;  ///< of the file on disk; empty where the user adds the file by hand
  std::string get;  ///< where `raystudy scene get` finds it: https:…, npm:package@version#path or deb:package#path; may be empty
  SourceLocation where;
};

/// What scenes/catalog.yaml says about one scene.
struct CatalogEntry {
  std::string name;
  std::string title;
  std::string source;                ///< where the model comes from
  std::string licence;               ///< its terms, as far as known
  std::string by_hand;               ///< how to add the file where no registry has it; may be empty
  std::int64_t triangles = 0;        ///< exact: a file with another count is refused; 0 (by-hand scenes only): not known
  std::vector<CatalogFile> files;    ///< the same scene in several forms; the first that is at hand is read
  std::vector<CatalogFile> frames;   ///< a `.f32` sequence, or one model a frame, all with the scene's topology
  std::optional<Material> material;  ///< of every triangle, instead of the file's own
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  SourceLocation where;
};

struct Catalog {
  std::string file;
  std::vector<CatalogEntry> entries;  ///< in the file's order

  [[nodiscard]] const CatalogEntry* find(std::string_view name) const;
};

/// RAYSTUDY_CATALOG, or the catalog of the source tree, or the installed one.
[[nodiscard]] std::filesystem::path catalog_path();
/// Throws one Error with every mistake of the file, each with line and column and the nearest valid key.
[[nodiscard]] Catalog read_catalog(const std::filesystem::path& file);

/// The entry of that name. Throws Error with the nearest name, procedural scenes included.
[[nodiscard]] const CatalogEntry& catalog_entry(const Catalog& catalog, std::string_view name);

/// `$XDG_CACHE_HOME/raystudy`, else `$HOME/.cache/raystudy`; nothing where neither variable is set.
[[nodiscard]] std::optional<std::filesystem::path> user_cache();
/// The folders of RAYSTUDY_SCENES, then `<user cache>/scenes`.
[[nodiscard]] std::vector<std::filesystem::path> scene_folders();
/// Where a catalog file is, or nothing.
[[nodiscard]] std::optional<std::filesystem::path> find_file(const CatalogFile& file);
/// The first of the entry's files that is at hand.
[[nodiscard]] const CatalogFile* installed_file(const CatalogEntry& entry);
/// Whether the model and all files of frames are at hand.
[[nodiscard]] bool is_installed(const CatalogEntry& entry);
/// 'scene not installed: raystudy scene get NAME', or how to add by hand what is missing, a file of frames by its number from 1.
[[nodiscard]] std::string not_installed_text(const CatalogEntry& entry);

}  // namespace raystudy
