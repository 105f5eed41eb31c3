#pragma once

#include <cmath>
#include <cstdint>

#include "harness/geometry/vec3.h"
#include "scenes/procedural/numeric.h"

namespace raystudy::procedural {

/// Hash of a lattice point; the finalizer is MurmurHash3's.
constexpr std::uint32_t lattice_hash(std::int32_t x, std::int32_t y, std::int32_t z, std::uint32_t seed) {
  std::uint32_t h = seed ^ (static_cast<std::uint32_t>(x) * 0x9e3779b1U) ^ (static_cast<std::uint32_t>(y) * 0x85ebca77U) ^
                    (static_cast<std::uint32_t>(z) * 0xc2b2ae3dU);
  h = (h ^ (h >> 16U)) * 0x85ebca6bU;
  h = (h ^ (h >> 13U)) * 0xc2b2ae35U;
  return h ^ (h >> 16U);
}

struct Noise2 {
  float value = 0;
  float dx = 0;
  float dy = 0;
};

/// Gradient noise (Perlin 2002, quintic fade) of the plane, about -0.7 to 0.7, with its derivatives.
inline Noise2 gradient_noise(double x, double y, std::uint32_t seed) {
  const double floor_x = std::floor(x);
  const double floor_y = std::floor(y);
  const auto ix = static_cast<std::int32_t>(floor_x);
  const auto iy = static_cast<std::int32_t>(floor_y);
  const auto fx = static_cast<float>(x - floor_x);
  const auto fy = static_cast<float>(y - floor_y);
  const float u = fx * fx * fx * (fx * (fx * 6 - 15) + 10);
  const float v = fy * fy * fy * (fy * (fy * 6 - 15) + 10);
  const float du = 30 * fx * fx * (fx * (fx - 2) + 1);
  const float dv = 30 * fy * fy * (fy * (fy - 2) + 1);
  struct Corner {
    float gx, gy, value;
  };
  const auto corner = [&](std::int32_t i, std::int32_t j) {
    const std::uint32_t h = lattice_hash(ix + i, iy + j, 0, seed);
    const float gx = static_cast<float>(static_cast<std::int16_t>(h & 0xffffU)) * 0x1p-15F;
    const float gy = static_cast<float>(static_cast<std::int16_t>(h >> 16U)) * 0x1p-15F;
    return Corner{gx, gy, gx * (fx - static_cast<float>(i)) + gy * (fy - static_cast<float>(j))};
  };
  const Corner a = corner(0, 0);
  const Corner b = corner(1, 0);
  const Corner c = corner(0, 1);
  const Corner d = corner(1, 1);
  const float k = a.value - b.value - c.value + d.value;
  return {a.value + u * (b.value - a.value) + v * (c.value - a.value) + u * v * k,
          a.gx + u * (b.gx - a.gx) + v * (c.gx - a.gx) + u * v * (a.gx - b.gx - c.gx + d.gx) + du * (b.value - a.value + v * k),
          a.gy + u * (b.gy - a.gy) + v * (c.gy - a.gy) + u * v * (a.gy - b.gy - c.gy + d.gy) + dv * (c.value - a.value + u * k)};
}

/// Gradient noise of space, about -0.8 to 0.8.
inline float gradient_noise(Vec3 p, std::uint32_t seed) {
  const Vec3 base{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  const auto ix = static_cast<std::int32_t>(base.x);
  const auto iy = static_cast<std::int32_t>(base.y);
  const auto iz = static_cast<std::int32_t>(base.z);
  const Vec3 f = p - base;
  const auto fade = [](float t) { return t * t * t * (t * (t * 6 - 15) + 10); };
  const auto corner = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
    const std::uint32_t h = lattice_hash(ix + i, iy + j, iz + k, seed);
    const float gx = static_cast<float>(h & 0x3ffU) * 0x1p-9F - 1;
    const float gy = static_cast<float>((h >> 10U) & 0x3ffU) * 0x1p-9F - 1;
    const float gz = static_cast<float>((h >> 20U) & 0x3ffU) * 0x1p-9F - 1;
    return gx * (f.x - static_cast<float>(i)) + gy * (f.y - static_cast<float>(j)) + gz * (f.z - static_cast<float>(k));
  };
  const float u = fade(f.x);
  const float v = fade(f.y);
  const float near = mixed(mixed(corner(0, 0, 0), corner(1, 0, 0), u), mixed(corner(0, 1, 0), corner(1, 1, 0), u), v);
  const float far = mixed(mixed(corner(0, 0, 1), corner(1, 0, 1), u), mixed(corner(0, 1, 1), corner(1, 1, 1), u), v);
  return mixed(near, far, fade(f.z));
}

/// Sum of `octaves` gradient noises, each of twice the frequency and half the height of the one before.
inline float fractal_noise(Vec3 p, int octaves, std::uint32_t seed) {
  float sum = 0;
  float amplitude = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += amplitude * gradient_noise(p, seed + static_cast<std::uint32_t>(i));
    p = p * 2.0F + Vec3{0.37F, 0.19F, 0.71F};
    amplitude *= 0.5F;
  }
  return sum;
}

}  // namespace raystudy::procedural
