#include "methods/vulkan/morton_order.h"

#include "harness/geometry/box.h"
#include "methods/vulkan/order_pushes.h"

namespace raystudy::gpu {
namespace {

constexpr std::size_t half_bounds_bytes = 3 * sizeof(std::uint32_t);

std::size_t words(std::uint32_t count) { return (std::size_t{count} + 1) * sizeof(std::uint32_t); }

std::size_t room_of(const RadixSort& sort, std::uint32_t n, bool two_words) {
  const std::size_t column = words(n);
  const std::size_t high = two_words ? column : 0;
  return vulkan::Arena::bytes_for(
      {n * sizeof(Box), 2 * half_bounds_bytes, sizeof(Box), sort.room_for(n), column, column, column, column, high, high});
}

}  // namespace

MortonOrder::MortonOrder(vulkan::Device& device, const DeviceScene& scene, std::uint32_t bits, const DeviceShape& shape)
    : device_(device),
      scene_(scene),
      shape_(shape),
      bits_(bits),
      count_(scene.triangle_count()),
      sort_(device, 0, bits, shape),
      arena_(device, room_of(sort_, count_, two_words())),
      boxes_(arena_.take(count_ * sizeof(Box))),
      bounds_(arena_.take(2 * half_bounds_bytes)),
      grid_(arena_.take(sizeof(Box))),
      sort_room_(arena_.take(sort_.room_for(count_))) {
  for (SortItems* items : {&items_, &other_}) {
    items->low = arena_.take(words(count_));
    items->values = arena_.take(words(count_));
    if (two_words()) items->high = arena_.take(words(count_));
  }
}

std::vector<vulkan::PartTime> MortonOrder::build() {
  vulkan::Commands commands(device_);
  const std::uint64_t groups = groups_for(count_, shape_.group * shape_.items);
  const std::uint64_t high = two_words() ? items_.high.address() : 0;
  commands.fill(bounds_.part(0, half_bounds_bytes), ~0U);
  commands.fill(bounds_.part(half_bounds_bytes, half_bounds_bytes), 0);
  commands.barrier();
  commands.mark("bounds");
  commands.run(device_.kernel("bounds", {shape_.group, shape_.items}),
               BoundsPush{scene_.vertices().address(), scene_.triangles().address(), boxes_.address(), bounds_.address(), count_},
               groups);
  commands.barrier();
  commands.mark("morton");
  commands.run(device_.kernel("morton_grid", {1}), GridPush{bounds_.address(), grid_.address(), bits_ / 3}, 1);
  commands.barrier();
  commands.run(device_.kernel("morton", {shape_.group, shape_.items, bits_ / 3}),
               MortonPush{boxes_.address(), grid_.address(), items_.low.address(), high, count_}, groups);
  commands.barrier();
  commands.mark("sort");
  sorted_ = &sort_.record(commands, items_, other_, count_, sort_room_);
  spare_ = sorted_ == &items_ ? &other_ : &items_;
  return commands.finish();
}

}  // namespace raystudy::gpu
