#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "harness/base/aligned.h"
#include "harness/base/radix_sort.h"
#include "methods/lbvh/triangle_boxes.h"

// Order and hierarchy of points 1 to 6 of README.md: places, codes, and what stands in the gaps between places.

namespace raystudy::lbvh {

/// What parts the triangle at a place from the one behind it: how high the highest differing bit of their keys is, and whether it
/// ends a leaf. A gap of a range is where the range is split if it is the highest; no range has two highest ones. One byte:
/// gaps of which both or none end a leaf compare as their heights.
using Gap = std::uint8_t;
inline constexpr Gap leaf_end = 0x80;     ///< set: it does
inline constexpr Gap treelet_end = 0xff;  ///< of a treelet, the last place of all included
inline constexpr Gap code_bit = 32;       ///< the height of the lowest bit of a code; lower ones are of places

/// The height of the split of places from `a` to `b`.
template <class Code>
[[nodiscard]] Gap height(const Code* codes, std::size_t a, std::size_t b) {
  const Code code = codes[a] ^ codes[b];
  return code != 0 ? static_cast<Gap>(code_bit - 1 + std::bit_width(code))
                   : static_cast<Gap>(std::bit_width(static_cast<std::uint32_t>(a ^ b)) - 1);
}

/// What decides a tree besides the scene.
struct Shape {
  int morton_bits = 30;  ///< of a code: 30 or 63
  std::uint32_t max_leaf_triangles = 1;
  int treelet_bits = 0;  ///< leading bits of a code that are the same within a treelet; 0: all is one
};

/// Bytes that sort_by_code needs for a triangle, the codes that it gives back included.
template <class Code>
inline constexpr std::size_t sort_room = sizeof(Code) + 2 * sizeof(Keyed<Code>);

/// Sorts the scene's triangles by their codes, equal ones in the scene's order. `room`: sort_room<Code> bytes a triangle, aligned
/// to
/// 64. Returns the codes by place.
template <class Code>
std::span<const Code> sort_by_code(const Scene& scene, int morton_bits, int threads, std::byte* room, std::uint32_t* order);

/// Sets the gaps behind places, as many as `codes`.
template <class Code>
void find_gaps(std::span<const Code> codes, const Shape& shape, int threads, Gap* gaps);

}  // namespace raystudy::lbvh
