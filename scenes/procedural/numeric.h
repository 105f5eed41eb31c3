#pragma once

#include <cmath>

#include "harness/geometry/vec3.h"

namespace raystudy::procedural {

// The scenes must be the same to the bit on every machine. Sums, products, quotients, square roots and floor are exactly rounded
// everywhere; the C library's sin, cos, exp and pow are not, so nothing here calls them.

/// Sine of `turns` full turns: odd Taylor polynomial on a quarter turn, error below 2^-30.
constexpr float sin_turns(double turns) {
  double x = turns - static_cast<double>(static_cast<long long>(turns));  // in (-1, 1)
  if (x > 0.5) x -= 1;
  if (x < -0.5) x += 1;
  if (x > 0.25) x = 0.5 - x;
  if (x < -0.25) x = -0.5 - x;
  const double a = x * 6.283185307179586;
  const double s = a * a;
  return static_cast<float>(
      a * (1 + s * (-1.0 / 6 + s * (1.0 / 120 + s * (-1.0 / 5040 + s * (1.0 / 362880 + s * (-1.0 / 39916800)))))));
}
constexpr float cos_turns(double turns) { return sin_turns(turns + 0.25); }

constexpr float mixed(float a, float b, float t) { return a + (b - a) * t; }
constexpr Vec3 mixed(Vec3 a, Vec3 b, float t) { return a + (b - a) * t; }
constexpr float clamped(float x, float low, float high) { return x < low ? low : x > high ? high : x; }
constexpr float squared(float x) { return x * x; }
/// 0 below `a`, 1 above `b`, smooth between.
constexpr float smooth_step(float a, float b, float x) {
  const float t = clamped((x - a) / (b - a), 0, 1);
  return t * t * (3 - 2 * t);
}
/// A bump of height 1 at 0 that falls smoothly to 0 at |x| = 1.
constexpr float bump(float x_squared) { return x_squared >= 1 ? 0 : squared(1 - x_squared) * (1 - x_squared); }

}  // namespace raystudy::procedural
