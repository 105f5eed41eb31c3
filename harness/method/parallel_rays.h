#pragma once

#include <algorithm>
#include <cstddef>

#include "harness/base/parallel.h"

namespace raystudy {

/// Rays in one task: enough to hide its cost, few enough to share out the work evenly.
inline constexpr std::size_t rays_in_tile = 1024;

/// Calls f(begin, end) for consecutive tiles of [0, count), on `threads` threads; on the calling one alone where `threads` is 1.
template <class F>
void for_ray_tiles(std::size_t count, int threads, const F& f) {
  const auto trace_tiles = [&](std::size_t first, std::size_t last) {
    for (std::size_t tile = first; tile < last; ++tile) {
      f(tile * rays_in_tile, std::min((tile + 1) * rays_in_tile, count));
    }
  };
  const std::size_t tiles = (count + rays_in_tile - 1) / rays_in_tile;
  if (threads <= 1) {
    trace_tiles(0, tiles);
  } else {
    with_threads(threads, [&] { parallel_for_blocks(tiles, 1, trace_tiles); });
  }
}

}  // namespace raystudy
