#include "methods/topdown/sweep_orders.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "harness/base/parallel.h"
#include "harness/base/radix_sort.h"

namespace raystudy::topdown {
namespace {

/// An integer in the order of floats; 0 and -0 are equal.
std::uint32_t sortable(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

float position(const Scene& scene, const BoxRecord& r, Positions positions, int axis, bool upper) {
  switch (positions) {
    case Positions::box_centers: return 0.5F * r.lower[axis] - 0.5F * r.negated_upper[axis];  // the sum alone may overflow
    case Positions::centroids: {
      const Triangle& t = scene.triangles[r.triangle];
      float sum = 0;
      for (int i = 0; i < 3; ++i) sum += scene.vertices[t[i]][axis] * (1.0F / 3);
      return sum;
    }
    case Positions::box_bounds: return upper ? -r.negated_upper[axis] : r.lower[axis];
  }
  return 0;
}

}  // namespace

void fill_records(const Scene& scene, int threads, std::span<BoxRecord> records) {
  parallel_for_blocks(records.size(), 4096, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto t = static_cast<std::uint32_t>(i);
      records[i] = BoxRecord::of(scene.triangle_box(t), t);
    }
  });
}

SweepOrders::SweepOrders(const Scene& scene, Positions positions, int threads, const std::function<void()>& meanwhile)
    : records(scene.triangles.size()) {
  fill_records(scene, threads, records);
  const int per_axis = positions == Positions::box_bounds ? 2 : 1;
  lists.resize(std::size_t{3} * static_cast<std::size_t>(per_axis));
  const auto sort = [&](int order) {
    const auto room = [n = records.size()] { return std::make_unique_for_overwrite<Keyed<std::uint32_t>[]>(n); };
    auto items = room();
    for (std::size_t i = 0; i < records.size(); ++i) {
      items[i] = {sortable(position(scene, records[i], positions, order / per_axis, order % per_axis == 1)),
                  static_cast<std::uint32_t>(i)};
    }
    auto& list = lists[static_cast<std::size_t>(order)];
    list = std::make_unique_for_overwrite<std::uint32_t[]>(records.size());
    radix_sort(std::move(items), room(), records.size(), 32, std::max(1, threads / count()),
               [&list](std::size_t place, const Keyed<std::uint32_t>& item) { list[place] = item.index; });
  };
  if (threads == 1) {
    for (int order = 0; order < count(); ++order) sort(order);
    meanwhile();
  } else {
    parallel_for_each(lists.size() + 1, [&](std::size_t i) { i < lists.size() ? sort(static_cast<int>(i)) : meanwhile(); });
  }
}

}  // namespace raystudy::topdown
