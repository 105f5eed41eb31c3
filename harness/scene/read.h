#pragma once

#include <filesystem>
#include <string>

#include "harness/scene/scene.h"

namespace raystudy {

/// Reads a scene from a file of any known format, compressed or inside an archive (`archive.zip/path/inside.obj`), by way of the
/// binary cache. Throws Error naming the file, and the line or byte where the format tells, for anything malformed: truncated
/// data, indices out of range, NaN or infinite vertices, no triangles.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file);

}  // namespace raystudy
