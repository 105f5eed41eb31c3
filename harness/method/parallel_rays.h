#pragma once

#include <algorithm>
#include <cstddef>

#include "harness/base/parallel.h"

namespace raystudy {

/// Rays in one task: enough to hide its cost, few enough to share out the work evenly.
inline constexpr std::size_t rays_in_tile = 1024;

/// Calls f(begin, end) for consecutive tiles of [0, count), `size` rays each, on `threads` threads; on the calling one alone
/// where `threads` is 1.
template <class F>
void for_ray_tiles(std::size_t count, std::size_t size, int threads, const F& f) {
  const auto trace_tiles = [&](std::size_t first, std::size_t last) {
    for (std::size_t tile = first; tile < last; ++tile) f(tile * size, std::min((tile + 1) * size, count));
  };
  const std::size_t tiles = (count + size - 1) / size;
  if (threads <= 1) {
    trace_tiles(0, tiles);
  } else {
    with_threads(threads, [&] { parallel_for_blocks(tiles, 1, trace_tiles); });
  }
}

/// The same with tiles of rays_in_tile.
template <class F>
void for_ray_tiles(std::size_t count, int threads, const F& f) {
  for_ray_tiles(count, rays_in_tile, threads, f);
}

}  // namespace raystudy
