#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

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
class MortonGrid {
 public:
  /// `bits` from 1 to 21. An axis along which the box has no extent has one cell.
  MortonGrid(const Box& bounds, int bits) : most_(static_cast<double>((1U << static_cast<unsigned>(bits)) - 1)) {
    for (int axis = 0; axis < 3; ++axis) {
      origin_[axis] = static_cast<double>(bounds.lower[axis]);
      const double extent = static_cast<double>(bounds.upper[axis]) - origin_[axis];
      scale_[axis] = extent > 0 ? (most_ + 1) / extent : 0;
    }
  }

  /// The code of the cell that holds `p`, of 3 · bits bits; points outside the box count to the nearest cell along each axis.
  [[nodiscard]] std::uint64_t code(Vec3 p) const { return morton_code(cell(p, 0), cell(p, 1), cell(p, 2)); }

 private:
  [[nodiscard]] std::uint32_t cell(Vec3 p, int axis) const {
    // In double: extents of floats overflow, and 21 bits of a difference of floats may be rounding.
    return static_cast<std::uint32_t>(std::clamp((static_cast<double>(p[axis]) - origin_[axis]) * scale_[axis], 0.0, most_));
  }

  double most_;
  double origin_[3];
  double scale_[3];
};

}  // namespace raystudy
