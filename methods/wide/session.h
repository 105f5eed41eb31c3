#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "harness/method/parallel_rays.h"
#include "methods/wide/kernels.h"

namespace raystudy::wide {

/// Rays through a wide tree by a kernel (wide::Kernel, or one with the same calls), tile by tile. Hits are those of testing every
/// triangle, bit for bit, whatever the tree, the kernel and the instruction set: boxes are tested conservatively (wide_ray.h),
/// triangles as watertight.h does. Of equal t the lowest triangle index is the hit.
template <class Kernel>
class Session final : public TraceSession {
 public:
  /// `tile` rays are traced by one call of the kernel.
  Session(const WideBvh& bvh, Kernel kernel, int threads, std::size_t tile = rays_in_tile)
      : tree_(bvh), kernel_(std::move(kernel)), empty_(bvh.empty()), threads_(threads), tile_(tile) {}

  void trace(std::span<const Ray> rays, std::span<Hit> hits, Query query) override {
    if (hits.size() != rays.size()) throw std::logic_error("as many hits as rays are needed");
    for_ray_tiles(rays.size(), tile_, threads_, [&](std::size_t begin, std::size_t end) {
      const auto out = hits.subspan(begin, end - begin);
      if (empty_) {
        std::fill(out.begin(), out.end(), Hit{});
      } else {
        kernel_.trace(tree_, rays.subspan(begin, end - begin), out, query);
      }
    });
  }

  [[nodiscard]] bool counts() const override { return true; }

  TraceCounts count(std::span<const Ray> rays, Query query, std::span<std::uint32_t> steps) override {
    if (!steps.empty() && steps.size() != rays.size()) throw std::logic_error("as many step counts as rays are needed, or none");
    if (empty_) {
      std::fill(steps.begin(), steps.end(), 0U);
      return {};
    }
    return kernel_.count(tree_, rays, query, steps);
  }

 private:
  Tree tree_;
  Kernel kernel_;
  bool empty_;
  int threads_;
  std::size_t tile_;
};

}  // namespace raystudy::wide
