#pragma once

#include <cstdint>
#include <vector>

#include "harness/accel/bvh2.h"
#include "harness/method/device_times.h"
#include "harness/vulkan/commands.h"

namespace raystudy::gpu {

/// Fetches a tree of nodes as Bvh2 has them and the triangles of its leaves; returns seconds by the wall clock.
double download_tree(vulkan::Device& device, const vulkan::Slice& nodes, std::uint32_t leaves, const vulkan::Slice& triangles,
                     std::uint32_t triangle_count, Bvh2& bvh);

/// Adds the times of `more` to those of `parts`, part by part.
void add_parts(std::vector<vulkan::PartTime>& parts, const std::vector<vulkan::PartTime>& more);

/// Tells a build's times, where they are asked for.
void report(DeviceTimes* times, const std::vector<vulkan::PartTime>& parts, double upload, double download,
            std::size_t peak_bytes);

}  // namespace raystudy::gpu
