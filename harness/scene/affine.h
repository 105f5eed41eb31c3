#pragma once

#include <array>
#include <cstddef>

#include "harness/geometry/vec3.h"

namespace raystudy {

/// An affine map: three columns and an origin, in double: readers chain many.
struct Affine {
  std::array<std::array<double, 3>, 4> column{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};

  [[nodiscard]] Vec3 point(Vec3 p) const { return apply(p, 1); }
  [[nodiscard]] Vec3 vector(Vec3 v) const { return apply(v, 0); }

 private:
  [[nodiscard]] Vec3 apply(Vec3 p, double w) const;
};
/// Scaled along the axes, then turned by the unit quaternion (x, y, z, w), then moved.
[[nodiscard]] Affine affine_of(const std::array<double, 3>& scale, const std::array<double, 4>& rotation,
                               const std::array<double, 3>& translation);
[[nodiscard]] Affine operator*(const Affine& a, const Affine& b);

}  // namespace raystudy
