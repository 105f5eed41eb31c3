#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "harness/geometry/vec3.h"

namespace raystudy {

/// Random numbers by their index: value(i) depends on the seed, the stream and i alone, so rays are the same whatever the order
/// or the threads they are made in. Two rounds of the 64-bit finalizer of SplitMix64 (Steele, Lea, Flood 2014).
class IndexedRandom {
 public:
  constexpr IndexedRandom(std::uint64_t seed, std::uint64_t stream) : key_(mix(seed + 0x9e3779b97f4a7c15U * (stream + 1))) {}

  [[nodiscard]] constexpr std::uint64_t bits(std::uint64_t i) const { return mix(key_ ^ mix(i + 0x9e3779b97f4a7c15U)); }
  /// Uniform in [0, 1).
  [[nodiscard]] constexpr float uniform(std::uint64_t i) const { return static_cast<float>(bits(i) >> 40U) * 0x1p-24F; }

 private:
  static constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31U);
  }
  std::uint64_t key_;
};

/// Two directions that form a right-handed orthonormal frame with the unit vector `n` (Duff et al., "Building an Orthonormal
/// Basis, Revisited", JCGT 6(1), 2017).
struct Frame {
  Vec3 tangent, bitangent, normal;
  explicit Frame(Vec3 n) : normal(n) {
    const float sign = std::copysign(1.0F, n.z);
    const float a = -1.0F / (sign + n.z);
    const float b = n.x * n.y * a;
    tangent = {1.0F + sign * n.x * n.x * a, sign * b, -sign * n.x};
    bitangent = {b, sign + n.y * n.y * a, -n.y};
  }
  [[nodiscard]] Vec3 to_world(Vec3 v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }
};

/// A unit direction around +z with density cos θ / π, from two uniform numbers in [0, 1) (Malley's method: a uniform point of the
/// disk, lifted to the hemisphere).
inline Vec3 cosine_direction(float a, float b) {
  const float radius = std::sqrt(a);
  const float angle = 2 * std::numbers::pi_v<float> * b;
  return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(max(0.0F, 1 - a))};
}

}  // namespace raystudy
