#include "methods/vulkan/device_refit.h"

#include <fmt/format.h>

#include <algorithm>

#include "harness/accel/tree_height.h"
#include "harness/base/error.h"
#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {
namespace {

struct ClimbPush {
  std::uint64_t nodes;
  std::uint64_t vertices;
  std::uint64_t corners;
  std::uint64_t leaves;
  std::uint64_t parents;
  std::uint64_t arrivals;
  std::uint32_t count;
};
struct LevelPush {
  std::uint64_t nodes;
  std::uint64_t vertices;
  std::uint64_t corners;
  std::uint64_t level;
  std::uint32_t count;
};

using Indices = std::vector<std::uint32_t>;

std::uint32_t node_count(const Bvh2& bvh) { return static_cast<std::uint32_t>(bvh.nodes.size()); }

Indices leaves_of(const Bvh2& bvh) {
  Indices leaves;
  for (std::uint32_t n = 0; n < node_count(bvh); ++n) {
    if (n != 1 && bvh.nodes[n].is_leaf()) leaves.push_back(n);
  }
  return leaves;
}

Indices parents_of(const Bvh2& bvh) {
  Indices parents(bvh.nodes.size() / 2);
  for (std::uint32_t n = 0; n < node_count(bvh); ++n) {
    if (n != 1 && !bvh.nodes[n].is_leaf()) parents[bvh.nodes[n].first / 2] = n;
  }
  return parents;
}

/// All nodes, level by level from the deepest.
Indices levels_of(const Bvh2& bvh, Indices& ends) {
  Indices order{0};
  Indices starts{0};
  for (std::size_t begin = 0; begin < order.size();) {
    const std::size_t end = order.size();
    for (; begin < end; ++begin) {
      const Bvh2Node& node = bvh.nodes[order[begin]];
      if (!node.is_leaf()) order.insert(order.end(), {node.first, node.first + 1});
    }
    starts.push_back(static_cast<std::uint32_t>(end));
  }
  std::reverse(order.begin(), order.end());
  for (std::size_t level = starts.size() - 1; level-- > 0;) {
    ends.push_back(static_cast<std::uint32_t>(order.size()) - starts[level]);
  }
  return order;
}

void require_short_loops(const Bvh2& bvh, DeviceRefitMethod method) {
  std::size_t steps = 0;
  for (std::uint32_t n = 0; n < node_count(bvh); ++n) {
    if (n != 1) steps = std::max<std::size_t>(steps, bvh.nodes[n].count);
  }
  steps *= 4;  // a triangle, and its three corners
  const std::size_t height = method == DeviceRefitMethod::atomics ? tree_height(bvh) : 0;
  if (steps + height <= DeviceRefit::most_steps) return;
  throw Error(
      Diagnostic{{},
                 fmt::format("refitting on a device: leaves of up to {} triangles{}", steps / 4,
                             height > 0 ? fmt::format(" in a tree of {} levels", height) : ""),
                 fmt::format("4 times the triangles and, with atomics, the levels to be {} at most", DeviceRefit::most_steps),
                 {}});
}

std::size_t bytes_of(const Indices& indices) { return indices.size() * sizeof(std::uint32_t); }

}  // namespace

struct DeviceRefit::Form {
  Form(const Bvh2& bvh, DeviceRefitMethod method) {
    if (bvh.empty()) return;
    require_short_loops(bvh, method);
    if (method == DeviceRefitMethod::atomics) {
      order = leaves_of(bvh);
      parents = parents_of(bvh);
    } else {
      order = levels_of(bvh, level_ends);
    }
  }

  Indices order;
  Indices parents;
  Indices level_ends;
};

DeviceRefit::DeviceRefit(vulkan::Device& device, const Bvh2& bvh, std::span<const Triangle> triangles, DeviceRefitMethod method)
    : DeviceRefit(device, bvh, triangles, method, Form(bvh, method)) {}

DeviceRefit::DeviceRefit(vulkan::Device& device, const Bvh2& bvh, std::span<const Triangle> triangles, DeviceRefitMethod method,
                         const Form& form)
    : method_(method),
      arena_(device, vulkan::Arena::bytes_for({bvh.nodes.size() * sizeof(Bvh2Node), bvh.triangles.size() * sizeof(Triangle),
                                               bytes_of(form.order), bytes_of(form.parents), bytes_of(form.parents)})),
      nodes_(arena_.take(bvh.nodes.size() * sizeof(Bvh2Node))),
      corners_(arena_.take(bvh.triangles.size() * sizeof(Triangle))),
      order_(arena_.take(bytes_of(form.order))),
      parents_(arena_.take(bytes_of(form.parents))),
      arrivals_(arena_.take(bytes_of(form.parents))),
      level_ends_(form.level_ends),
      group_(shape_of(device).group),
      kernel_(device.kernel(method == DeviceRefitMethod::atomics ? "refit_climb" : "refit_level",
                            {group_, shape_of(device).fences ? 1U : 0U})) {
  std::vector<Triangle> corners;
  corners.reserve(bvh.triangles.size());
  for (const std::uint32_t t : bvh.triangles) corners.push_back(triangles[t]);
  vulkan::upload(device, nodes_, std::as_bytes(std::span(bvh.nodes.data(), bvh.nodes.size())));
  vulkan::upload(device, corners_, std::span<const Triangle>(corners));
  vulkan::upload(device, order_, std::span<const std::uint32_t>(form.order));
  vulkan::upload(device, parents_, std::span<const std::uint32_t>(form.parents));
  vulkan::upload(device, arrivals_, std::span<const std::uint32_t>(Indices(form.parents.size(), 0)));
}

void DeviceRefit::record(vulkan::Commands& commands, const vulkan::Slice& vertices) const {
  if (method_ == DeviceRefitMethod::atomics) {
    const auto count = static_cast<std::uint32_t>(order_.bytes / sizeof(std::uint32_t));
    commands.run(kernel_,
                 ClimbPush{nodes_.address(), vertices.address(), corners_.address(), order_.address(), parents_.address(),
                           arrivals_.address(), count},
                 groups_for(count, group_));
    commands.barrier();
    return;
  }
  std::uint32_t begin = 0;
  for (const std::uint32_t end : level_ends_) {
    commands.run(kernel_,
                 LevelPush{nodes_.address(), vertices.address(), corners_.address(),
                           order_.address() + begin * sizeof(std::uint32_t), end - begin},
                 groups_for(end - begin, group_));
    commands.barrier();
    begin = end;
  }
}

}  // namespace raystudy::gpu
