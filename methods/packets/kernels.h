#pragma once

#include <cstdint>
#include <span>

#include "harness/accel/wide_bvh.h"
#include "harness/method/method.h"
#include "methods/wide/kernels.h"

namespace raystudy::packets {

/// How the children of a node are tested against a packet as a whole, before any of its rays.
enum class Culling : std::uint8_t {
  none,      ///< not at all
  interval,  ///< slabs with intervals for the rays' origins and reciprocals
  frustum    ///< four planes around the rays, and slabs along the axis that the rays follow
};

struct PacketOptions {
  std::uint32_t size = 64;  ///< rays in a packet: 4, 16, 64 or 256
  Culling culling = Culling::interval;
  bool first_active = true;  ///< a child is entered for the first vector of rays that meets it; else all vectors are tested
};

/// The traversal of one kind of node in one instruction set. Packets are made of consecutive rays.
struct Functions {
  void (*trace)(const wide::Tree& tree, const PacketOptions& options, std::span<const Ray> rays, std::span<Hit> hits,
                Query query);
  TraceCounts (*count)(const wide::Tree& tree, const PacketOptions& options, std::span<const Ray> rays, Query query,
                       std::span<std::uint32_t> steps);
};

/// The same with its options.
class Kernel {
 public:
  Kernel(const Functions& functions, const PacketOptions& options) : functions_(functions), options_(options) {}
  void trace(const wide::Tree& tree, std::span<const Ray> rays, std::span<Hit> hits, Query query) const {
    functions_.trace(tree, options_, rays, hits, query);
  }
  [[nodiscard]] TraceCounts count(const wide::Tree& tree, std::span<const Ray> rays, Query query,
                                  std::span<std::uint32_t> steps) const {
    return functions_.count(tree, options_, rays, query, steps);
  }

 private:
  Functions functions_;
  PacketOptions options_;
};

/// Throws Error where the processor lacks `simd`.
[[nodiscard]] Kernel kernel_for(const WideBvh& bvh, wide::Simd simd, const PacketOptions& options);

}  // namespace raystudy::packets
