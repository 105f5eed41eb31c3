#pragma once

#include <cmath>

#include "harness/geometry/vec3.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {

/// A rotation where it has unit length.
struct Quaternion {
  float w = 1;
  Vec3 v;

  friend constexpr Quaternion operator*(Quaternion a, Quaternion b) {
    return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
  }
  friend constexpr Quaternion operator+(Quaternion a, Quaternion b) { return {a.w + b.w, a.v + b.v}; }
  friend constexpr Quaternion operator*(Quaternion a, float s) { return {a.w * s, a.v * s}; }
};
constexpr float dot(Quaternion a, Quaternion b) { return a.w * b.w + dot(a.v, b.v); }
inline Quaternion normalized(Quaternion q) { return q * (1 / std::sqrt(dot(q, q))); }

/// `p` turned by the rotation `q`.
constexpr Vec3 turned(Quaternion q, Vec3 p) {
  const Vec3 t = 2.0F * cross(q.v, p);
  return p + q.w * t + cross(q.v, t);
}
/// `q` after a time `dt` at angular velocity `spin` (radians a unit of time), to first order.
inline Quaternion spun(Quaternion q, Vec3 spin, float dt) { return normalized(q + Quaternion{0, spin * (0.5F * dt)} * q); }

/// Between two rotations, along the shorter way: a straight line, normalized.
inline Quaternion blended(Quaternion a, Quaternion b, float t) { return normalized(a * (1 - t) + b * (dot(a, b) < 0 ? -t : t)); }

/// The rotation that carries the coordinate axes to the orthonormal x, y, z (right-handed).
inline Quaternion rotation_to(Vec3 x, Vec3 y, Vec3 z) {
  // Four times the squares of the components; the largest is the one to divide by.
  const float w = 1 + x.x + y.y + z.z;
  const float i = 1 + x.x - y.y - z.z;
  const float j = 1 - x.x + y.y - z.z;
  const float k = 1 - x.x - y.y + z.z;
  if (w >= i && w >= j && w >= k) return normalized(Quaternion{w, {y.z - z.y, z.x - x.z, x.y - y.x}});
  if (i >= j && i >= k) return normalized(Quaternion{y.z - z.y, {i, y.x + x.y, z.x + x.z}});
  if (j >= k) return normalized(Quaternion{z.x - x.z, {y.x + x.y, j, z.y + y.z}});
  return normalized(Quaternion{x.y - y.x, {z.x + x.z, z.y + y.z, k}});
}

/// A uniformly random rotation, by rejection from the ball of four dimensions.
inline Quaternion random_rotation(Random& random) {
  for (;;) {
    const float w = random.uniform(-1, 1);
    const float x = random.uniform(-1, 1);
    const float y = random.uniform(-1, 1);
    const float z = random.uniform(-1, 1);
    const Quaternion q{w, {x, y, z}};
    const float n = dot(q, q);
    if (n <= 1 && n > 0.01F) return normalized(q);
  }
}

}  // namespace raystudy::procedural
