#pragma once

#include <cstdint>

namespace raystudy::gpu {

/// Push constants of the kernels with which every order of triangles begins: addresses, and how many triangles there are.
struct BoundsPush {  // bounds.comp
  std::uint64_t vertices;
  std::uint64_t triangles;
  std::uint64_t boxes;
  std::uint64_t bounds;
  std::uint32_t count;
};
struct GridPush {  // morton_grid.comp
  std::uint64_t bounds;
  std::uint64_t grid;
  std::uint32_t bits;
};
struct MortonPush {  // morton.comp
  std::uint64_t boxes;
  std::uint64_t grid;
  std::uint64_t low;
  std::uint64_t high;
  std::uint32_t count;
};

}  // namespace raystudy::gpu
