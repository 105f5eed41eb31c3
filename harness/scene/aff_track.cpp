#include "harness/scene/aff_track.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace raystudy {
namespace {

using Quaternion = std::array<double, 4>;
using Vector = std::array<double, 3>;

Quaternion product(const Quaternion& a, const Quaternion& b) {
  const auto [ax, ay, az, aw] = a;
  const auto [bx, by, bz, bw] = b;
  return {aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw,
          aw * bw - ax * bx - ay * by - az * bz};
}

/// Half the turn from `a` to `b`, the shorter way, as a vector along its axis.
Vector half_turn(const Quaternion& a, const Quaternion& b) {
  Quaternion r = product({-a[0], -a[1], -a[2], a[3]}, b);
  if (r[3] < 0) {
    for (double& k : r) k = -k;
  }
  const double sine = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  if (sine < 1e-12) return {};
  const double factor = std::atan2(sine, r[3]) / sine;
  return {r[0] * factor, r[1] * factor, r[2] * factor};
}

/// `q`, then turned by twice `half` (in its own frame) times `share`.
Quaternion turned(const Quaternion& q, const Vector& half, double share) {
  const double angle = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]) * std::fabs(share);
  const double factor = angle < 1e-12 ? share : share * std::sin(angle) / angle;
  return product(q, {half[0] * factor, half[1] * factor, half[2] * factor, std::cos(angle)});
}

Vector difference(const Vector& a, const Vector& b) { return {b[0] - a[0], b[1] - a[1], b[2] - a[2]}; }
Vector difference(const Quaternion& a, const Quaternion& b) { return half_turn(a, b); }

enum class Side : unsigned char { incoming, outgoing };

/// The curve's tangent at key k, for the segment before or after it (Kochanek and Bartels 1984, equations 8, 9 and 11).
template <std::size_t N>
Vector tangent(const std::vector<AffKey<N>>& keys, std::size_t k, Side side) {
  const AffKey<N>& key = keys[k];
  const double before = key.time - keys[k - 1].time;
  const double after = keys[k + 1].time - key.time;
  const double continuity = side == Side::outgoing ? key.continuity : -key.continuity;
  const bool increases = before >= 0 && after >= 0 && before + after > 0;
  const double adjust = increases ? 2 * (side == Side::outgoing ? after : before) / (before + after) : 1;
  const double of_before = adjust * 0.5 * (1 - key.tension) * (1 + continuity) * (1 + key.bias);
  const double of_after = adjust * 0.5 * (1 - key.tension) * (1 - continuity) * (1 - key.bias);
  const Vector from = difference(keys[k - 1].value, key.value);
  const Vector to = difference(key.value, keys[k + 1].value);
  return {of_before * from[0] + of_after * to[0], of_before * from[1] + of_after * to[1], of_before * from[2] + of_after * to[2]};
}

Vector between(const Vector& a, const Vector& leaving, const Vector& b, const Vector& arriving, double u) {
  Vector out{};
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = (2 * u * u * u - 3 * u * u + 1) * a[i] + (u * u * u - 2 * u * u + u) * leaving[i] +
             (3 * u * u - 2 * u * u * u) * b[i] + (u * u * u - u * u) * arriving[i];
  }
  return out;
}

/// The same curve on the sphere of rotations: its Bezier points by great arcs (Shoemake 1985).
Quaternion between(const Quaternion& a, const Vector& leaving, const Quaternion& b, const Vector& arriving, double u) {
  std::array<Quaternion, 4> points{a, turned(a, leaving, 1.0 / 3), turned(b, arriving, -1.0 / 3), b};
  for (std::size_t left = 3; left > 0; --left) {
    for (std::size_t i = 0; i < left; ++i) points[i] = turned(points[i], half_turn(points[i], points[i + 1]), u);
  }
  return points[0];
}

template <std::size_t N>
std::array<double, N> value_at(const std::vector<AffKey<N>>& keys, double time) {
  const std::size_t last = keys.size() - 2;
  if (time <= keys[1].time) return keys[1].value;
  if (time >= keys[last].time) return keys[last].value;
  std::size_t k = 1;
  while (keys[k + 1].time <= time) ++k;
  const double u = (time - keys[k].time) / (keys[k + 1].time - keys[k].time);
  return between(keys[k].value, tangent(keys, k, Side::outgoing), keys[k + 1].value, tangent(keys, k + 1, Side::incoming), u);
}

}  // namespace

Affine AffTrack::at(double time) const {
  return affine_of(scale.empty() ? Vector{1, 1, 1} : value_at(scale, time),
                   rotation.empty() ? Quaternion{0, 0, 0, 1} : value_at(rotation, time),
                   translation.empty() ? Vector{} : value_at(translation, time));
}

Quaternion turn_around(const Vector& axis, double degrees) {
  const double length = std::sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
  if (length == 0) return {0, 0, 0, 1};
  const double half = degrees * std::numbers::pi / 360;
  const double factor = std::sin(half) / length;
  return {axis[0] * factor, axis[1] * factor, axis[2] * factor, std::cos(half)};
}

}  // namespace raystudy
