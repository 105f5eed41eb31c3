#pragma once

#include <cstdint>
#include <span>

#include "harness/accel/wide_bvh.h"
#include "harness/method/method.h"
#include "methods/streams/ray_sorter.h"
#include "methods/wide/kernels.h"

namespace raystudy::streams {

struct StreamOptions {
  std::uint32_t size = 64;      ///< rays in a stream: 32 or 64
  std::uint32_t block = 16384;  ///< consecutive rays that are sorted together
  SortKey sort;
};

/// The traversal of one kind of node in one instruction set.
struct Functions {
  void (*trace)(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays, std::span<Hit> hits,
                Query query);
  TraceCounts (*count)(const wide::Tree& tree, const StreamOptions& options, std::span<const Ray> rays, Query query,
                       std::span<std::uint32_t> steps);
};

/// The same with its options.
class Kernel {
 public:
  Kernel(const Functions& functions, const StreamOptions& options) : functions_(functions), options_(options) {}
  void trace(const wide::Tree& tree, std::span<const Ray> rays, std::span<Hit> hits, Query query) const {
    functions_.trace(tree, options_, rays, hits, query);
  }
  [[nodiscard]] TraceCounts count(const wide::Tree& tree, std::span<const Ray> rays, Query query,
                                  std::span<std::uint32_t> steps) const {
    return functions_.count(tree, options_, rays, query, steps);
  }

 private:
  Functions functions_;
  StreamOptions options_;
};

/// Throws Error where the processor lacks `simd`.
[[nodiscard]] Kernel kernel_for(const WideBvh& bvh, wide::Simd simd, const StreamOptions& options);

}  // namespace raystudy::streams
