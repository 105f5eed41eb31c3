#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "harness/geometry/box.h"

namespace raystudy {

/// The lowest 21 bits of x, two zeros between each and the next.
constexpr std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffffU;
  x = (x | x << 32U) & 0x001f00000000ffffU;
  x = (x | x << 16U) & 0x001f0000ff0000ffU;
  x = (x | x << 8U) & 0x100f00f00f00f00fU;
  x = (x | x << 4U) & 0x10c30c30c30c30c3U;
  return (x | x << 2U) & 0x1249249249249249U;
}

/// The Morton code of a cell of up to 21 bits an axis: the bits of x, y and z in turn, that of x foremost.
constexpr std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread_bits(x) << 2U | spread_bits(y) << 1U | spread_bits(z);
}

/// A grid of 2^bits cells an axis over a box; every axis has cells of its own length, so that all of them are used.
///
/// Cells are found by single multiplications and subtractions of floats that are rounded to nearest, and by integers, so that a
/// shader finds the same, whether or not it fuses the products (halves are exact) and whatever it makes of denormal numbers. Of
/// a center c along an axis of the box from lo to hi, with h = hi / 2 - lo / 2:
///   scale = 2^bits / h, rounded toward zero; 0 where h < 2^-76 or not finite
///   cell  = the integer part of (c / 2 - lo / 2) · scale, at most 2^bits - 1; 0 where that is negative or not a number
/// Nothing overflows up to the largest float, and a center farther along an axis is never in a cell before another's. That
/// flushed denormals change nothing is what 2^-76 is for: at the bounds of cells, multiples of 2^-97 and more, what is less than
/// 2^-126 is rounded away.
class MortonGrid {
 public:
  /// `bits` from 2 to 21.
  MortonGrid(const Box& bounds, int bits) : last_cell_(static_cast<float>((1U << static_cast<unsigned>(bits)) - 1)) {
    for (int axis = 0; axis < 3; ++axis) {
      half_lower_[axis] = 0.5F * bounds.lower[axis];
      scale_[axis] = cells_per_length(0.5F * bounds.upper[axis] - half_lower_[axis], bits);
    }
  }

  /// The center of a box as grids take it. The sum of the bounds alone might overflow.
  [[nodiscard]] static constexpr Vec3 center(const Box& box) { return 0.5F * box.lower + 0.5F * box.upper; }

  /// The code of the cell that holds `p`, of 3 · bits bits; points outside the box count to the nearest cell along each axis.
  [[nodiscard]] std::uint64_t code(Vec3 p) const { return morton_code(cell(p, 0), cell(p, 1), cell(p, 2)); }

  /// The cell of `p` along `axis`.
  [[nodiscard]] std::uint32_t cell(Vec3 p, int axis) const {
    const float place = (0.5F * p[axis] - half_lower_[axis]) * scale_[axis];
    return static_cast<std::uint32_t>(place > 0 ? min(last_cell_, place) : 0);
  }

  // What cells are found by.
  [[nodiscard]] Vec3 half_lower() const { return half_lower_; }
  [[nodiscard]] Vec3 scale() const { return scale_; }
  [[nodiscard]] float last_cell() const { return last_cell_; }

 private:
  /// 2^bits / h, rounded toward zero.
  static float cells_per_length(float h, int bits) {
    if (!(h >= 0x1p-76F && h <= std::numeric_limits<float>::max())) return 0;
    const auto word = std::bit_cast<std::uint32_t>(h);
    const std::uint64_t mantissa = (word & 0x7fffffU) | 0x800000U;  // h = mantissa · 2^(exponent - 150)
    const int exponent = static_cast<int>(word >> 23U);
    const auto quotient =
        static_cast<std::uint32_t>((std::uint64_t{1} << 47U) / mantissa);  // from 2^23 to 2^24: exact as a float
    return std::ldexp(static_cast<float>(quotient), bits - (exponent - 150) - 47);
  }

  float last_cell_;
  Vec3 half_lower_;
  Vec3 scale_;
};

}  // namespace raystudy
