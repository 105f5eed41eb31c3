#pragma once

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace raystudy {

/// Rays in one task: enough to hide its cost, few enough to share out the work evenly.
inline constexpr std::size_t rays_in_tile = 1024;

/// Calls f(begin, end) for consecutive tiles of [0, count), on `threads` threads; on the calling one alone where `threads` is 1.
template <class F>
void for_ray_tiles(std::size_t count, int threads, const F& f) {
  if (threads <= 1) {
    for (std::size_t begin = 0; begin < count; begin += rays_in_tile) {
      f(begin, begin + rays_in_tile < count ? begin + rays_in_tile : count);
    }
    return;
  }
  tbb::task_arena arena(threads);
  arena.execute([&] {
    const std::size_t tiles = (count + rays_in_tile - 1) / rays_in_tile;
    tbb::parallel_for(std::size_t{0}, tiles, [&](std::size_t tile) {
      const std::size_t begin = tile * rays_in_tile;
      f(begin, begin + rays_in_tile < count ? begin + rays_in_tile : count);
    });
  });
}

}  // namespace raystudy
