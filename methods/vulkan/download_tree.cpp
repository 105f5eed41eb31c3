#include "methods/vulkan/download_tree.h"

#include <algorithm>
#include <span>

namespace raystudy::gpu {

double download_tree(vulkan::Device& device, const vulkan::Slice& nodes, std::uint32_t leaves, const vulkan::Slice& triangles,
                     std::uint32_t triangle_count, Bvh2& bvh) {
  bvh.nodes.resize(2 * std::size_t{leaves});
  bvh.triangles.resize(triangle_count);
  return vulkan::download(device, nodes, std::as_writable_bytes(std::span(bvh.nodes))) +
         vulkan::download(device, triangles, std::as_writable_bytes(std::span(bvh.triangles)));
}

void add_parts(std::vector<vulkan::PartTime>& parts, const std::vector<vulkan::PartTime>& more) {
  for (const vulkan::PartTime& part : more) {
    const auto same = std::find_if(parts.begin(), parts.end(), [&](const vulkan::PartTime& p) { return p.part == part.part; });
    if (same == parts.end()) {
      parts.push_back(part);
    } else {
      same->seconds += part.seconds;
    }
  }
}

void report(DeviceTimes* times, const std::vector<vulkan::PartTime>& parts, double upload, double download,
            std::size_t peak_bytes) {
  if (times == nullptr) return;
  times->seconds = vulkan::total_seconds(parts);
  times->upload = upload;
  times->download = download;
  times->parts.clear();
  for (const vulkan::PartTime& part : parts) times->parts.push_back({part.part, part.seconds});
  times->peak_bytes = peak_bytes;
}

}  // namespace raystudy::gpu
