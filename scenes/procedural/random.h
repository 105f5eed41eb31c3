#pragma once

#include <cmath>
#include <cstdint>

#include "scenes/procedural/numeric.h"

namespace raystudy::procedural {

/// Mixes 64 bits so that each output bit depends on all input bits (the finalizer of SplitMix64; Steele, Lea, Flood 2014).
constexpr std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

/// Random numbers that are a pure function of (seed, stream, how many were drawn before): SplitMix64. Parts of a scene draw from
/// streams of their own, so that they can be made in any order and on any thread.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(mix(seed) + mix(~stream)) {}

  constexpr std::uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15ULL); }
  /// In [0, 1), a multiple of 2^-24.
  constexpr float uniform() { return static_cast<float>(bits() >> 40U) * 0x1p-24F; }
  constexpr float uniform(float low, float high) { return low + (high - low) * uniform(); }
  /// In [0, n).
  constexpr int below(int n) { return static_cast<int>((bits() >> 32U) * static_cast<std::uint64_t>(n) >> 32U); }

 private:
  std::uint64_t state_;
};

/// A point of the unit sphere's surface: uniform height, uniform turn.
inline Vec3 random_direction(Random& random) {
  const float y = random.uniform(-1, 1);
  const double turn = random.uniform();
  const float r = std::sqrt(1 - y * y);
  return {r * cos_turns(turn), y, r * sin_turns(turn)};
}

}  // namespace raystudy::procedural
