#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "harness/base/error.h"
#include "harness/scene/catalog.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// A catalog scene whose files are neither on RAYSTUDY_SCENES nor in the user's cache. A visible row, never a substitute:
/// 'scene not installed: raystudy scene get NAME', or that it must be added by hand.
class SceneNotInstalled : public Error {
 public:
  using Error::Error;
};

/// Opens a scene by name: a procedural one (`triangles` and `seed` apply) or one of the catalog (scenes/catalog.yaml; its
/// cameras, lights and materials are added). A name with a '/' is a file's path, read as it is. Throws Error with the nearest
/// name, SceneNotInstalled, or what is wrong with the file.
[[nodiscard]] Scene open_scene(std::string_view name, std::int64_t triangles = 0, std::uint64_t seed = 1);
/// The same with a catalog that is read already.
[[nodiscard]] Scene open_scene(const Catalog& catalog, std::string_view name, std::int64_t triangles, std::uint64_t seed);

/// What SceneNotInstalled would say; nothing where open_scene would not throw it. Looks for the scene's files and reads none.
[[nodiscard]] std::optional<std::string> why_not_installed(const Catalog& catalog, std::string_view name);

}  // namespace raystudy
