#include "methods/vulkan/sah_hybrid.h"

#include <cstring>

#include "harness/geometry/box.h"
#include "methods/vulkan/device_shape.h"
#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/order_pushes.h"

namespace raystudy::gpu {
namespace {

constexpr std::size_t word = sizeof(std::uint32_t);
constexpr std::uint32_t code_bits = 30;

struct CellsPush {
  std::uint64_t boxes;
  std::uint64_t indices;
  std::uint64_t codes;
  std::uint64_t starts;
  std::uint64_t minima;
  std::uint64_t maxima;
  std::uint32_t count;
  std::uint32_t levels;
};
struct TopPush {
  std::uint64_t top;
  std::uint64_t minima;
  std::uint64_t maxima;
  std::uint64_t nodes;
  std::uint32_t count;
};

constexpr std::uint32_t cell_items = 64;  ///< triangles of an invocation that looks for the bounds of cells

}  // namespace

LbvhLevels::LbvhLevels(vulkan::Device& device, const SahMemory& memory, std::uint32_t levels, std::uint32_t count)
    : device_(device),
      memory_(memory),
      levels_(levels),
      count_(count),
      cells_(1U << levels),
      sort_(device, code_bits - levels, code_bits),
      arena_(device, vulkan::Arena::bytes_for({sizeof(Box), (cells_ + 1) * word, 3 * cells_ * word, 3 * cells_ * word,
                                               2 * cells_ * sizeof(TopNode), sort_.room_for(count), count * word, count * word,
                                               count * word, count * word})),
      readback_(device, (cells_ + 1) * word, vulkan::Buffer::Kind::staging),
      grid_(arena_.take(sizeof(Box))),
      starts_(arena_.take((cells_ + 1) * word)),
      minima_(arena_.take(3 * cells_ * word)),
      maxima_(arena_.take(3 * cells_ * word)),
      top_(arena_.take(2 * cells_ * sizeof(TopNode))),
      sort_room_(arena_.take(sort_.room_for(count))) {
  for (SortItems* items : {&items_, &other_}) {
    items->low = arena_.take(count * word);
    items->values = arena_.take(count * word);
  }
}

void LbvhLevels::order(const vulkan::Slice& bounds, vulkan::Commands& commands) {
  const DeviceShape shape = shape_of(device_);
  commands.fill(minima_, ~0U);
  commands.fill(maxima_, 0);
  commands.run(device_.kernel("morton_grid", {1}), GridPush{bounds.address(), grid_.address(), code_bits / 3}, 1);
  commands.barrier();
  commands.run(device_.kernel("morton", {shape.group, shape.items, code_bits / 3}),
               MortonPush{memory_.boxes.address(), grid_.address(), items_.low.address(), 0, count_},
               groups_for(count_, std::uint64_t{shape.group} * shape.items));
  commands.barrier();
  const SortItems& sorted = sort_.record(commands, items_, other_, count_, sort_room_);
  commands.copy(sorted.values, memory_.indices);
  commands.run(device_.kernel("sah_cells", {shape.group, cell_items}),
               CellsPush{memory_.boxes.address(), sorted.values.address(), sorted.low.address(), starts_.address(),
                         minima_.address(), maxima_.address(), count_, levels_},
               groups_for(count_, std::uint64_t{shape.group} * cell_items));
  commands.barrier();
  commands.copy(starts_, readback_.all());
}

void LbvhLevels::lay_out(std::vector<TopNode>& top, std::vector<SahNode>& leaves) {
  std::vector<std::uint32_t> starts(cells_ + 1);
  std::memcpy(starts.data(), readback_.mapped(), starts.size() * word);
  struct Range {
    std::uint32_t node;
    std::uint32_t first;
    std::uint32_t end;
  };
  std::vector<Range> stack{{0, 0, cells_}};
  while (!stack.empty()) {
    const auto [node, first, end] = stack.back();
    stack.pop_back();
    const std::uint32_t begin = starts[first];
    const std::uint32_t count = starts[end] - begin;
    const std::uint32_t middle = first + (end - first) / 2;
    if (count == 1 || end - first == 1) {
      top.push_back({node, first, end, begin, count});
      leaves.push_back({node, begin, count});
    } else if (starts[middle] == begin || starts[middle] == starts[end]) {  // the cells of one half are empty
      const bool right = starts[middle] == begin;
      stack.push_back({node, right ? middle : first, right ? end : middle});
    } else {
      const std::uint32_t pair = 2 * starts[middle];
      top.push_back({node, first, end, pair, 0});
      stack.push_back({pair + 1, middle, end});
      stack.push_back({pair, first, middle});
    }
  }
}

std::vector<SahNode> LbvhLevels::build(const vulkan::Slice& bounds, std::vector<vulkan::PartTime>& parts) {
  vulkan::Commands ordering(device_);
  ordering.mark("LBVH");
  order(bounds, ordering);
  add_parts(parts, ordering.finish());
  std::vector<TopNode> top;
  std::vector<SahNode> leaves;
  lay_out(top, leaves);
  vulkan::upload(device_, top_, std::span<const TopNode>(top));
  vulkan::Commands boxes(device_);
  boxes.mark("LBVH");
  const std::uint32_t group = shape_of(device_).group;
  const auto count = static_cast<std::uint32_t>(top.size());
  boxes.run(device_.kernel("sah_top", {group}),
            TopPush{top_.address(), minima_.address(), maxima_.address(), memory_.nodes.address(), count},
            groups_for(count, group));
  add_parts(parts, boxes.finish());
  return leaves;
}

}  // namespace raystudy::gpu
