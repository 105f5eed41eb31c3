// Morton codes of 30 bits, in one word, or of 60 or 63, in two. MortonGrid of harness/geometry/morton.h says which cell a point is in, to
// the last bit.
struct Grid {
  vec3 half_lower;
  vec3 scale;
};

layout(buffer_reference, scalar, buffer_reference_align = 8) buffer Grids { Grid at[]; };

// 2^bits / h, rounded toward zero: 2^47 over the mantissa of h, bit after bit, then the exponent.
float cells_per_length(float h, uint bits) {
  if (!(h >= 1.3234889800848443e-23 && h <= 3.4028234663852886e38)) return 0;  // 2^-76, the largest float
  const uint word = floatBitsToUint(h);
  const uint mantissa = (word & 0x7fffffu) | 0x800000u;
  uint quotient = 0;
  uint remainder = 1;
  for (uint bit = 0; bit < 47; ++bit) {
    remainder <<= 1;
    quotient <<= 1;
    if (remainder >= mantissa) {
      remainder -= mantissa;
      quotient |= 1;
    }
  }
  const int exponent = int(bits) + 150 - 47 - int(word >> 23);
  return uintBitsToFloat(floatBitsToUint(float(quotient)) + (uint(exponent) << 23));
}

Grid grid_over(vec3 lower, vec3 upper, uint bits) {
  Grid grid;
  for (uint axis = 0; axis < 3; ++axis) {
    grid.half_lower[axis] = 0.5 * lower[axis];
    precise const float h = 0.5 * upper[axis] - grid.half_lower[axis];
    grid.scale[axis] = cells_per_length(h, bits);
  }
  return grid;
}

vec3 box_center(Box box) {
  precise const vec3 center = 0.5 * box.lower + 0.5 * box.upper;
  return center;
}

uvec3 cell_of(Grid grid, vec3 p, uint bits) {
  precise const vec3 place = (0.5 * p - grid.half_lower) * grid.scale;
  const float most = float((1u << bits) - 1);
  uvec3 cell;
  for (uint axis = 0; axis < 3; ++axis) cell[axis] = place[axis] > 0 ? uint(min(most, place[axis])) : 0;
  return cell;
}

// The lowest 10 bits of x, two zeros between each and the next.
uvec3 spread_bits(uvec3 x) {
  x &= 0x3ffu;
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}
uint code_of_10(uvec3 cell) {
  const uvec3 spread = spread_bits(cell);
  return spread.x << 2 | spread.y << 1 | spread.z;
}
// Of cells of up to 21 bits an axis: the low word ends with z and y of bit 10, the high one begins with x of it.
uint low_code_of_21(uvec3 cell) { return code_of_10(cell) | (cell.z >> 10 & 1) << 30 | (cell.y >> 10 & 1) << 31; }
uint high_code_of_21(uvec3 cell) { return (cell.x >> 10 & 1) | code_of_10(cell >> 11) << 1; }
