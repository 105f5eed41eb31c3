#pragma once

#include <array>
#include <span>

#include "harness/geometry/box.h"

namespace raystudy {

/// Whether every point of the triangle lies in one of the boxes at least. Decided by cutting the triangle along the boxes' faces,
/// in double: exact where the faces that part two boxes are the same float, up to 2⁻⁵⁰ of the triangle's size elsewhere.
[[nodiscard]] bool boxes_cover(std::span<const Box> boxes, const std::array<Vec3, 3>& triangle);

}  // namespace raystudy
