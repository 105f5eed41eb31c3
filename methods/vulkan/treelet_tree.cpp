#include "methods/vulkan/treelet_tree.h"

#include <fmt/format.h>

#include "harness/base/error.h"
#include "methods/vulkan/apetrei.h"
#include "methods/vulkan/download_tree.h"

namespace raystudy::gpu {
namespace {

struct EndsPush {
  std::uint64_t depths;
  std::uint64_t flags;
  std::uint32_t count;
  std::uint32_t least_depth;
};
struct RangesPush {
  std::uint64_t ranks;
  std::uint64_t first;
  std::uint32_t count;
};
struct BeginPush {
  std::uint64_t order;
  std::uint64_t tasks;
  std::uint64_t queues;
  std::uint64_t places;
  std::uint32_t treelets;
};
struct NextPush {
  std::uint64_t queues;
  std::uint32_t next;
};
struct SplitPush {
  std::uint64_t roots;
  std::uint64_t treelet_first;
  std::uint64_t leaf_first;
  std::uint64_t from;
  std::uint64_t to;
  std::uint64_t tasks;
  std::uint64_t next_tasks;
  std::uint64_t queues;
  std::uint64_t nodes;
  std::uint64_t places;
  std::uint32_t level;
};
struct LayoutPush {
  std::uint64_t roots;
  std::uint64_t from;
  std::uint64_t to;
  std::uint64_t order;
  std::uint64_t triangles;
  std::uint64_t leaf_first;
  std::uint64_t treelets;
  std::uint64_t treelet_first;
  std::uint64_t places;
  std::uint32_t leaves;
};

constexpr std::size_t word = sizeof(std::uint32_t);
constexpr std::size_t task_bytes = 5 * word;  // Task, Place and Queue of shaders/treelets.glsl
constexpr std::size_t place_bytes = 3 * word;
constexpr std::size_t queue_bytes = 4 * word;
// llvmpipe ends an invocation's loops after 65535 rounds in all, whatever is left; a group of 8 goes over a node's treelets three
// times.
constexpr std::uint32_t most_treelets_on_processor = 1U << 17U;
constexpr int levels_at_once = 8;  // between looks at whether anything is left to be split

std::size_t pairs_bytes(std::uint32_t leaves) { return 2 * std::size_t{leaves} * sizeof(Bvh2Node); }

std::size_t room_of(const PrefixSum& sum, const LbvhLeaves& leaves) {
  const std::size_t column = (std::size_t{leaves.count()} + 1) * word;
  return vulkan::Arena::bytes_for({pairs_bytes(leaves.count()), pairs_bytes(leaves.count()), leaves.order().count() * word,
                                   column, column, column, sum.room_for(leaves.count())});
}

std::size_t top_room(std::uint32_t treelets) {
  const std::size_t order = treelets * word;
  const std::size_t tasks = (treelets / 2 + 1) * task_bytes;
  return vulkan::Arena::bytes_for(
      {treelets * sizeof(Bvh2Node), treelets * place_bytes, 2 * queue_bytes, order, order, tasks, tasks});
}

}  // namespace

TreeletTree::Top::Top(vulkan::Device& device, std::uint32_t treelets)
    : arena(device, top_room(treelets)),
      roots(arena.take(treelets * sizeof(Bvh2Node))),
      places(arena.take(treelets * place_bytes)),
      queues(arena.take(2 * queue_bytes)),
      orders{arena.take(treelets * word), arena.take(treelets * word)},
      tasks{arena.take((treelets / 2 + 1) * task_bytes), arena.take((treelets / 2 + 1) * task_bytes)} {}

TreeletTree::TreeletTree(vulkan::Device& device, const LbvhLeaves& leaves, std::uint32_t least_depth, std::uint32_t bins)
    : device_(device),
      leaves_(leaves),
      least_depth_(least_depth),
      bins_(bins),
      sum_(device, leaves.order().shape()),
      arena_(device, room_of(sum_, leaves)),
      nodes_(arena_.take(pairs_bytes(leaves.count()))),
      triangles_(arena_.take(leaves.order().count() * word)),
      treelet_nodes_(arena_.take(pairs_bytes(leaves.count()))),
      ends_(arena_.take((std::size_t{leaves.count()} + 1) * word)),
      treelet_of_(arena_.take((std::size_t{leaves.count()} + 1) * word)),
      treelet_first_(arena_.take((std::size_t{leaves.count()} + 1) * word)),
      sum_room_(arena_.take(sum_.room_for(leaves.count()))) {}

void TreeletTree::build(std::vector<vulkan::PartTime>& parts) {
  find_treelets(parts);
  top_ = std::make_unique<Top>(device_, count_);
  build_treelets(parts);
  split(parts);
  lay_out(parts);
}

/// Numbers the treelets and finds their first leaves.
void TreeletTree::find_treelets(std::vector<vulkan::PartTime>& parts) {
  const DeviceShape& shape = leaves_.order().shape();
  const std::uint32_t n = leaves_.count();
  vulkan::Commands commands(device_);
  commands.mark("treelets");
  commands.run(device_.kernel("treelets_ends", {shape.group}), EndsPush{leaves_.depths(), treelet_of_.address(), n, least_depth_},
               groups_for(n, shape.group));
  commands.barrier();
  sum_.record(commands, treelet_of_, n, sum_room_);
  commands.run(device_.kernel("treelets_ranges", {shape.group}), RangesPush{treelet_of_.address(), treelet_first_.address(), n},
               groups_for(n, shape.group));
  commands.barrier();
  add_parts(parts, commands.finish());
  count_ = read_word(device_, treelet_of_, n) + 1;
  if (device_.info().type == "cpu" && count_ > most_treelets_on_processor) {
    throw Error(fmt::format("{} treelets are more than {} splits; expected {} at most: use fewer sah_bits", count_,
                            device_.info().name, most_treelets_on_processor));
  }
}

void TreeletTree::build_treelets(std::vector<vulkan::PartTime>& parts) {
  vulkan::Commands commands(device_);
  commands.mark("hierarchy");
  record_apetrei(device_, commands, leaves_, {treelet_nodes_, ends_, least_depth_, top_->roots, treelet_of_});
  add_parts(parts, commands.finish());
}

void TreeletTree::record_level(vulkan::Commands& commands) {
  const std::uint32_t level = top_->level;
  const std::uint32_t next = 1 - level;
  commands.run_indirect(device_.kernel("treelets_split", {leaves_.order().shape().scan_group, bins_}),
                        SplitPush{top_->roots.address(), treelet_first_.address(), leaves_.first(), top_->orders[level].address(),
                                  top_->orders[next].address(), top_->tasks[level].address(), top_->tasks[next].address(),
                                  top_->queues.address(), nodes_.address(), top_->places.address(), level},
                        top_->queues.part(level * queue_bytes, queue_bytes));
  commands.barrier();
  commands.run(device_.kernel("treelets_next", {1}), NextPush{top_->queues.address(), next}, 1);
  commands.barrier();
  top_->level = next;
}

/// Level by level, until a queue is empty.
void TreeletTree::split(std::vector<vulkan::PartTime>& parts) {
  const DeviceShape& shape = leaves_.order().shape();
  for (bool first = true; first || read_word(device_, top_->queues, 4 * top_->level + 3) > 0; first = false) {
    vulkan::Commands commands(device_);
    commands.mark("sah");
    if (first) {
      commands.run(
          device_.kernel("treelets_begin", {shape.group}),
          BeginPush{top_->orders[0].address(), top_->tasks[0].address(), top_->queues.address(), top_->places.address(), count_},
          groups_for(count_, shape.group));
      commands.barrier();
    }
    for (int level = 0; level < levels_at_once; ++level) record_level(commands);
    add_parts(parts, commands.finish());
  }
}

void TreeletTree::lay_out(std::vector<vulkan::PartTime>& parts) {
  const DeviceShape& shape = leaves_.order().shape();
  vulkan::Commands commands(device_);
  commands.mark("layout");
  commands.fill(nodes_.part(sizeof(Bvh2Node), sizeof(Bvh2Node)), 0);
  commands.run(device_.kernel("treelets_layout", {shape.group}),
               LayoutPush{top_->roots.address(), treelet_nodes_.address(), nodes_.address(), leaves_.order().order().address(),
                          triangles_.address(), leaves_.first(), treelet_of_.address(), treelet_first_.address(),
                          top_->places.address(), leaves_.count()},
               groups_for(leaves_.count(), shape.group));
  add_parts(parts, commands.finish());
}

}  // namespace raystudy::gpu
