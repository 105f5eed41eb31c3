#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "harness/accel/accel.h"
#include "harness/scene/bytes.h"
#include "harness/scene/scene.h"

namespace raystudy {

// Trees as files: a Bvh2 or a WideBvh in the format that tree_file.md describes.

/// The version of the format that is written, and the only one that is read.
inline constexpr std::uint32_t tree_file_version = 1;

/// What is known of a tree's making: the cost model it was made under, and free text.
struct TreeNotes {
  float traversal = 3;     ///< c_T
  float intersection = 2;  ///< c_I
  std::string heuristic;   ///< the measure of boxes, with its parameters
  std::string provenance;  ///< lines, e.g. the pipeline with all parameters, the seed and the version of the code
};

/// What a file holds.
struct TreeFile {
  std::unique_ptr<Accel> tree;  ///< a Bvh2 or a WideBvh
  std::string scene;            ///< name of the scene it was made for
  std::string scene_hash;       ///< its Scene::hash
  std::uint64_t scene_triangles = 0;
  TreeNotes notes;
  std::uint64_t bytes = 0;  ///< of the file
};

/// Whether trees of that Accel::kind can be saved.
[[nodiscard]] bool is_saveable(std::string_view kind);

/// Writes the file atomically; the same tree and notes give the same bytes. Throws Error, naming the file, where the tree is of
/// another kind, is not valid over the scene, or the file cannot be written.
void save_tree(const std::filesystem::path& file, const Accel& tree, const Scene& scene, const TreeNotes& notes);

/// Reads a file without its scene: what comes back can be walked through, but whether its boxes hold the scene's triangles is not
/// known. Throws Error, naming the file, where it cannot be read, is no tree file, of another version, cut off, damaged, or holds
/// a tree that is not valid by itself (find_structural_problems).
[[nodiscard]] TreeFile read_tree(const std::filesystem::path& file);

/// Reads a file and finds its tree valid over `scene` (find_problems). Throws Error as read_tree does, and where the tree is over
/// another scene.
[[nodiscard]] TreeFile load_tree(const std::filesystem::path& file, const Scene& scene);

/// The same of a file's content; messages call it `name`.
[[nodiscard]] TreeFile read_tree(std::string_view name, const Bytes& content);
[[nodiscard]] TreeFile load_tree(std::string_view name, const Bytes& content, const Scene& scene);

}  // namespace raystudy
