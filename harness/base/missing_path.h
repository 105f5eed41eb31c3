#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace raystudy {

/// Why a path leads nowhere, in the words a user needs to mend it.
struct MissingPath {
  std::string absent_folder;  ///< the first of its folders that is not there; empty where all are
  std::string nearest;        ///< the path with what is not there replaced by the nearest name that is; empty where none is near
};

/// Looks around a path that is not there. A file's nearest name is sought among those with one of `extensions` (with the dot; any
/// where there are none), an absent folder's among the folders beside it.
[[nodiscard]] MissingPath look_around(const std::filesystem::path& path, const std::vector<std::string_view>& extensions = {});

}  // namespace raystudy
