#pragma once

#include <filesystem>
#include <string_view>

#include "harness/scene/scene.h"

namespace raystudy {

/// Appends the key frames that `file` holds to `scene`, which was read from `model`: a sequence (.f32: x, y and z of every vertex
/// as 32-bit floats, frame after frame), or a model of one frame, whose triangles must join the same vertices. Throws Error that
/// names the file and the frame by its number in the scene, from 0, for one of another size or topology, a vertex that is not
/// finite, and for models that move of themselves.
void add_frames(Scene& scene, std::string_view model, const std::filesystem::path& file);

}  // namespace raystudy
