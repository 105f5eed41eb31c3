#pragma once

#include <cstdint>
#include <vector>

#include "harness/vulkan/commands.h"
#include "methods/vulkan/radix_sort.h"
#include "methods/vulkan/sah_memory.h"

namespace raystudy::gpu {

/// The first levels of an LBVH, whose leaves the SAH then splits (Lauterbach 2010, Sec. 5.3): triangles are sorted by the
/// foremost bits of their Morton codes of 30 bits, a level a bit. methods/lbvh/README.md defines codes, order and splits.
class LbvhLevels {
 public:
  static constexpr std::uint32_t most_levels = 12;

  /// `levels` from 1 to most_levels.
  LbvhLevels(vulkan::Device& device, const SahMemory& memory, std::uint32_t levels, std::uint32_t count);

  /// Orders the indices and writes the nodes. `bounds`: of the scene, as bounds.comp leaves them. What it runs is added to
  /// `parts` as "LBVH". Returns the leaves of the levels.
  std::vector<SahNode> build(const vulkan::Slice& bounds, std::vector<vulkan::PartTime>& parts);

 private:
  /// A node over cells, for sah_top.comp.
  struct TopNode {
    std::uint32_t node;
    std::uint32_t first_cell;
    std::uint32_t end_cell;
    std::uint32_t first;
    std::uint32_t count;
  };

  void order(const vulkan::Slice& bounds, vulkan::Commands& commands);
  void lay_out(std::vector<TopNode>& top, std::vector<SahNode>& leaves);

  vulkan::Device& device_;
  const SahMemory& memory_;
  std::uint32_t levels_;
  std::uint32_t count_;
  std::uint32_t cells_;
  RadixSort sort_;
  vulkan::Arena arena_;
  vulkan::Buffer readback_;
  vulkan::Slice grid_;
  vulkan::Slice starts_;
  vulkan::Slice minima_;
  vulkan::Slice maxima_;
  vulkan::Slice top_;
  vulkan::Slice sort_room_;
  SortItems items_;
  SortItems other_;
};

}  // namespace raystudy::gpu
