#include "methods/vulkan/prefix_sum.h"

namespace raystudy::gpu {
namespace {

struct TilesPush {
  std::uint64_t values;
  std::uint64_t sums;
  std::uint32_t count;
};
struct OfTilesPush {
  std::uint64_t sums;
  std::uint64_t total;
  std::uint32_t tiles;
};

}  // namespace

PrefixSum::PrefixSum(vulkan::Device& device, const DeviceShape& shape)
    : tile_(shape.scan_group * shape.scan_items),
      sum_tiles_(device.kernel("sum_tiles", {shape.scan_group, shape.scan_items})),
      sum_of_tiles_(device.kernel("sum_of_tiles", {shape.scan_group})),
      sum_before_(device.kernel("sum_before", {shape.scan_group, shape.scan_items})) {}

std::uint64_t PrefixSum::tiles_of(std::uint64_t n) const { return groups_for(n, tile_); }

std::size_t PrefixSum::room_for(std::uint64_t n) const { return tiles_of(n) * sizeof(std::uint32_t); }

void PrefixSum::record(vulkan::Commands& commands, const vulkan::Slice& values, std::uint32_t n,
                       const vulkan::Slice& room) const {
  const std::uint64_t tiles = tiles_of(n);
  const TilesPush push{values.address(), room.address(), n};
  const std::uint64_t total = values.address() + std::uint64_t{n} * sizeof(std::uint32_t);
  commands.run(sum_tiles_, push, tiles);
  commands.barrier();
  commands.run(sum_of_tiles_, OfTilesPush{room.address(), total, static_cast<std::uint32_t>(tiles)}, 1);
  commands.barrier();
  commands.run(sum_before_, push, tiles);
  commands.barrier();
}

}  // namespace raystudy::gpu
