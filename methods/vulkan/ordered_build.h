#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "harness/method/method.h"
#include "harness/vulkan/commands.h"
#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/morton_order.h"

namespace raystudy::gpu {

/// What every builder does that begins with an order along the Morton curve, with codes of `bits` bits. `grow(order, parts, bvh)`
/// makes the tree on the device, adds its times to `parts`, fetches it into `bvh` and returns the seconds of fetching.
template <class Grow>
std::unique_ptr<Bvh2> build_in_morton_order(const Scene& scene, std::uint32_t bits, const BuildContext& context,
                                            const Grow& grow) {
  vulkan::Device& device = vulkan::Device::shared();
  auto bvh = std::make_unique<Bvh2>();
  if (scene.triangles.empty()) return bvh;
  device.reset_peak_bytes();
  const DeviceScene on_device(device, scene);
  MortonOrder order(device, on_device, bits);
  std::vector<vulkan::PartTime> parts = order.build();
  const double download = grow(order, parts, *bvh);
  report(context.device, parts, on_device.upload_seconds(), download, device.peak_bytes());
  return bvh;
}

}  // namespace raystudy::gpu
