#pragma once

#include <cstdint>
#include <vector>

#include "harness/scene/scene.h"
#include "scenes/procedural/mesh.h"

namespace raystudy::procedural {

/// A point of the stand's ground plan, `out` metres outside the running track's inner edge: the superellipse of exponent 4, whose
/// corners leave room for the pitch's.
[[nodiscard]] Vec3 oval(float turns, float out, float height);

/// A stadium around the origin: pitch, running track (9 m wide), terraces of `rows` rows in `around` sections, roof and masts:
/// few, large triangles of the first `stands_material_count` materials.
void stands(Mesh& mesh, int around, int rows, int masts);
inline constexpr std::uint32_t stands_material_count = 10;
[[nodiscard]] std::vector<Material> stands_materials();

}  // namespace raystudy::procedural
