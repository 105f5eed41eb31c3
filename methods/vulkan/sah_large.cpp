#include "methods/vulkan/sah_large.h"

#include <cstring>

#include "methods/vulkan/device_shape.h"

namespace raystudy::gpu {
namespace {

constexpr std::size_t word = sizeof(std::uint32_t);

struct BoundsPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t minima;
  std::uint64_t maxima;
  std::uint32_t begin;
  std::uint32_t count;
};
struct TestPush {
  BoundsPush bounds;
  float spacing;
};
struct ChoosePush {
  std::uint64_t nodes;
  std::uint64_t minima;
  std::uint64_t maxima;
  std::uint64_t result;
  std::uint32_t node;
  std::uint32_t max_leaf;
  float traversal;
  float intersection;
  float spacing;
};
struct FlagsPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t flags;
  std::uint64_t result;
  std::uint32_t begin;
  std::uint32_t count;
};
struct ScatterPush {
  std::uint64_t indices;
  std::uint64_t sums;
  std::uint64_t to;
  std::uint64_t result;
  std::uint32_t begin;
  std::uint32_t count;
};

/// How a large node is split (shaders/sah_segments.glsl).
struct Result {
  std::uint32_t lefts;  ///< 0: it is a leaf
  std::uint32_t axis;
  float position;
  std::uint32_t index;
};

std::uint32_t pieces(std::uint32_t n, std::uint32_t size) { return static_cast<std::uint32_t>(groups_for(n, size)); }

/// Segments of a node: of either half.
std::uint32_t segments_of(const SahNode& node) {
  return pieces(node.count / 2, LargeSplits::segment) + pieces(node.count - node.count / 2, LargeSplits::segment);
}

}  // namespace

vulkan::Constants candidate_constants(const vulkan::Device& device, std::uint32_t samples) {
  const std::uint32_t candidates = 3 * samples;
  const std::uint32_t own = device.info().type == "cpu" ? 8 : pieces(candidates, 192);
  return {pieces(candidates, own), samples, own, LargeSplits::segment};
}

LargeSplits::LargeSplits(vulkan::Device& device, const SahMemory& memory, const SahParams& params, std::uint32_t count)
    : memory_(memory),
      params_(params),
      count_(count),
      sum_(device),
      group_(shape_of(device).group),
      bounds_(device.kernel("sah_large_bounds", {group_, params.samples, 1, segment})),
      test_(device.kernel("sah_large_test", candidate_constants(device, params.samples))),
      choose_(device.kernel("sah_large_choose", candidate_constants(device, params.samples))),
      flags_(device.kernel("sah_large_flags", {group_})),
      scatter_(device.kernel("sah_large_scatter", {group_})),
      minima_bytes_((3 + 6 * (3 * std::size_t{params.samples} + 1)) * word),
      maxima_bytes_((3 + 7 * (3 * std::size_t{params.samples} + 1)) * word),
      arena_(device, vulkan::Arena::bytes_for({most_nodes(count) * minima_bytes_, most_nodes(count) * maxima_bytes_,
                                               most_nodes(count) * sizeof(Result), sum_.room_for(count), count * word})),
      readback_(device, most_nodes(count) * sizeof(Result), vulkan::Buffer::Kind::staging),
      minima_(arena_.take(most_nodes(count) * minima_bytes_)),
      maxima_(arena_.take(most_nodes(count) * maxima_bytes_)),
      results_(arena_.take(most_nodes(count) * sizeof(Result))),
      sums_room_(arena_.take(sum_.room_for(count))),
      moved_(arena_.take(count * word)) {}

void LargeSplits::record_splits(vulkan::Commands& commands, std::span<const SahNode> nodes) const {
  commands.fill(minima_.part(0, nodes.size() * minima_bytes_), ~0U);
  commands.fill(maxima_.part(0, nodes.size() * maxima_bytes_), 0);
  commands.barrier();
  const auto push = [&](std::size_t i) {
    return BoundsPush{memory_.boxes.address(), memory_.indices.address(),
                      minima(i).address(),     maxima(i).address(),
                      nodes[i].begin,          nodes[i].count};
  };
  for (std::size_t i = 0; i < nodes.size(); ++i) commands.run(bounds_, push(i), segments_of(nodes[i]));
  commands.barrier();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    commands.run(test_, TestPush{push(i), params_.spacing()}, segments_of(nodes[i]));
  }
  commands.barrier();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    commands.run(
        choose_,
        ChoosePush{memory_.nodes.address(), minima(i).address(), maxima(i).address(), results_.address() + i * sizeof(Result),
                   nodes[i].node, params_.max_leaf(), params_.leaves.traversal, params_.leaves.intersection, params_.spacing()},
        1);
  }
  commands.barrier();
}

void LargeSplits::record_reorder(vulkan::Commands& commands, std::span<const SahNode> nodes) const {
  commands.fill(memory_.scratch.part(0, count_ * word), 0);
  commands.barrier();
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    commands.run(flags_,
                 FlagsPush{memory_.boxes.address(), memory_.indices.address(), memory_.scratch.address(),
                           results_.address() + i * sizeof(Result), nodes[i].begin, nodes[i].count},
                 pieces(nodes[i].count, group_));
  }
  commands.barrier();
  sum_.record(commands, memory_.scratch, count_, sums_room_);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    commands.run(scatter_,
                 ScatterPush{memory_.indices.address(), memory_.scratch.address(), moved_.address(),
                             results_.address() + i * sizeof(Result), nodes[i].begin, nodes[i].count},
                 pieces(nodes[i].count, group_));
  }
  commands.barrier();
  for (const SahNode& node : nodes) {
    const std::size_t begin = node.begin * word;
    commands.copy(moved_.part(begin, node.count * word), memory_.indices.part(begin, node.count * word));
  }
  commands.barrier();
}

void LargeSplits::record_results(vulkan::Commands& commands, std::span<const SahNode> nodes) const {
  commands.copy(results_.part(0, nodes.size() * sizeof(Result)), readback_.all());
}

std::vector<SahNode> LargeSplits::children(std::span<const SahNode> nodes) const {
  std::vector<SahNode> all;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const SahNode& node = nodes[i];
    Result result{};
    std::memcpy(&result, readback_.mapped() + i * sizeof(Result), sizeof(Result));
    if (result.lefts == 0) continue;
    const std::uint32_t middle = node.begin + result.lefts;
    all.push_back({2 * middle, node.begin, result.lefts});
    all.push_back({2 * middle + 1, middle, node.count - result.lefts});
  }
  return all;
}

}  // namespace raystudy::gpu
