#include "methods/vulkan/ploc_tree.h"

#include <utility>

#include "methods/vulkan/download_tree.h"
#include "methods/vulkan/lbvh_leaves.h"

namespace raystudy::gpu {
namespace {

struct BeginPush {
  std::uint64_t boxes;
  std::uint64_t order;
  std::uint64_t clusters;
  std::uint64_t links;
  std::uint32_t count;
};
struct NearestPush {
  std::uint64_t clusters;
  std::uint64_t nearest;
  std::uint32_t count;
  std::uint32_t radius;
};
struct PairsPush {
  std::uint64_t nearest;
  std::uint64_t marks;
  std::uint32_t count;
};
struct MergePush {
  std::uint64_t clusters;
  std::uint64_t links;
  std::uint64_t next_clusters;
  std::uint64_t next_links;
  std::uint64_t nearest;
  std::uint64_t ranks;
  std::uint64_t nodes;
  std::uint64_t leaves;
  std::uint32_t count;
  std::uint32_t triangles;
  std::uint32_t merges;
};
struct LayoutPush {
  std::uint64_t from;
  std::uint64_t leaves;
  std::uint64_t places;
  std::uint64_t to;
  std::uint64_t order;
  std::uint64_t triangles;
  std::uint64_t clusters;
  std::uint64_t links;
  std::uint32_t first;
  std::uint32_t end;
};

constexpr std::size_t word = sizeof(std::uint32_t);

std::size_t marks_bytes(std::size_t n) { return (2 * n + 1) * word; }

std::size_t room_of(const PrefixSum& sum, std::size_t n) {
  const std::size_t pairs = 2 * n * sizeof(Bvh2Node);
  return vulkan::Arena::bytes_for({pairs, n * word, pairs, n * word, 2 * n * word, n * word, marks_bytes(n), sum.room_for(2 * n),
                                   n * sizeof(Box), n * word, n * sizeof(Box), n * word});
}

}  // namespace

PlocTree::PlocTree(vulkan::Device& device, const MortonOrder& order, std::uint32_t radius)
    : device_(device),
      order_(order),
      radius_(radius),
      sum_(device, order.shape()),
      arena_(device, room_of(sum_, order.count())),
      nodes_(arena_.take(2 * std::size_t{order.count()} * sizeof(Bvh2Node))),
      triangles_(arena_.take(order.count() * word)),
      merged_(arena_.take(nodes_.bytes)),
      leaves_(arena_.take(order.count() * word)),
      places_(arena_.take(2 * order.count() * word)),
      nearest_(arena_.take(order.count() * word)),
      marks_(arena_.take(marks_bytes(order.count()))),
      sum_room_(arena_.take(sum_.room_for(2 * std::uint64_t{order.count()}))) {
  for (Clusters* clusters : {&clusters_, &next_}) {
    clusters->boxes = arena_.take(order.count() * sizeof(Box));
    clusters->links = arena_.take(order.count() * word);
  }
}

void PlocTree::record_round(vulkan::Commands& commands, std::uint32_t count, std::uint32_t merges) const {
  const DeviceShape& shape = order_.shape();
  commands.mark("nearest");
  const std::uint32_t group_clusters = shape.scan_group * shape.clusters;
  commands.run(device_.kernel("ploc_nearest", {shape.scan_group, group_clusters + 2 * radius_, shape.clusters}),
               NearestPush{clusters_.boxes.address(), nearest_.address(), count, radius_}, groups_for(count, group_clusters));
  commands.barrier();
  commands.mark("merge");
  commands.run(device_.kernel("ploc_pairs", {shape.group}), PairsPush{nearest_.address(), marks_.address(), count},
               groups_for(count, shape.group));
  commands.barrier();
  sum_.record(commands, marks_, 2 * count, sum_room_);
  commands.run(
      device_.kernel("ploc_merge", {shape.group}),
      MergePush{clusters_.boxes.address(), clusters_.links.address(), next_.boxes.address(), next_.links.address(),
                nearest_.address(), marks_.address(), merged_.address(), leaves_.address(), count, order_.count(), merges},
      groups_for(count, shape.group));
  commands.barrier();
}

void PlocTree::record_layout(vulkan::Commands& commands, bool root, std::uint32_t first, std::uint32_t end) const {
  const std::uint32_t group = root ? 1 : order_.shape().group;
  commands.run(device_.kernel("ploc_layout", {group, root ? 1U : 0U}),
               LayoutPush{merged_.address(), leaves_.address(), places_.address(), nodes_.address(), order_.order().address(),
                          triangles_.address(), clusters_.boxes.address(), clusters_.links.address(), first, end},
               groups_for(end - first, group));
  commands.barrier();
}

void PlocTree::build(std::vector<vulkan::PartTime>& parts) {
  const std::uint32_t n = order_.count();
  const std::uint32_t group = order_.shape().group;
  std::vector<std::uint32_t> merges{0};  // after each round, all that were made by then
  for (std::uint32_t count = n; merges.size() == 1 || count > 1;) {
    vulkan::Commands commands(device_);
    commands.mark("merge");
    if (merges.size() == 1) {
      commands.run(
          device_.kernel("ploc_begin", {group}),
          BeginPush{order_.boxes().address(), order_.order().address(), clusters_.boxes.address(), clusters_.links.address(), n},
          groups_for(n, group));
      commands.barrier();
    }
    if (count > 1) record_round(commands, count, merges.back());
    add_parts(parts, commands.finish());
    if (count == 1) break;
    count = read_word(device_, marks_, count);
    merges.push_back(n - count);
    std::swap(clusters_, next_);
  }
  vulkan::Commands commands(device_);
  commands.mark("layout");
  record_layout(commands, true, 0, 1);
  for (std::size_t round = merges.size() - 1; round > 0; --round) {
    record_layout(commands, false, n - merges[round], n - merges[round - 1]);
  }
  add_parts(parts, commands.finish());
}

}  // namespace raystudy::gpu
