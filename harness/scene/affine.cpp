#include "harness/scene/affine.h"

namespace raystudy {

Vec3 Affine::apply(Vec3 p, double w) const {
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    out[k] = column[0][k] * static_cast<double>(p.x) + column[1][k] * static_cast<double>(p.y) +
             column[2][k] * static_cast<double>(p.z) + column[3][k] * w;
  }
  return {static_cast<float>(out[0]), static_cast<float>(out[1]), static_cast<float>(out[2])};
}

Affine operator*(const Affine& a, const Affine& b) {
  Affine product;
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 0; k < 3; ++k) {
      product.column[c][k] = a.column[0][k] * b.column[c][0] + a.column[1][k] * b.column[c][1] + a.column[2][k] * b.column[c][2] +
                             (c == 3 ? a.column[3][k] : 0);
    }
  }
  return product;
}

Affine affine_of(const std::array<double, 3>& scale, const std::array<double, 4>& rotation,
                 const std::array<double, 3>& translation) {
  Affine t;
  const auto [x, y, z, w] = rotation;
  t.column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)};
  t.column[1] = {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
  t.column[2] = {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)};
  for (std::size_t c = 0; c < 3; ++c) {
    for (double& k : t.column[c]) k *= scale[c];
  }
  t.column[3] = translation;
  return t;
}

}  // namespace raystudy
