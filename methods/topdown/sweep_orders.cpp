#include "methods/topdown/sweep_orders.h"

#include <array>
#include <bit>
#include <utility>

#include "harness/base/parallel.h"

namespace raystudy::topdown {
namespace {

/// An integer in the order of floats; 0 and -0 are equal.
std::uint32_t sortable(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x + 0.0F);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

struct KeyedIndex {
  std::uint32_t key;
  std::uint32_t index;
};

/// Sorts by key and, being stable, leaves equal keys in the order of indices: a least-significant-digit radix sort of three
/// passes of 11 bits. Returns the sorted indices.
std::unique_ptr<std::uint32_t[]> sorted_indices(std::unique_ptr<KeyedIndex[]> items, std::size_t n) {
  constexpr int bits = 11;
  constexpr std::size_t digits = std::size_t{1} << bits;
  const auto digit = [](std::uint32_t key, int pass) { return (key >> (pass * bits)) & (digits - 1); };
  std::vector<std::array<std::uint32_t, digits>> starts(3);
  for (std::size_t i = 0; i < n; ++i) {
    for (int pass = 0; pass < 3; ++pass) ++starts[static_cast<std::size_t>(pass)][digit(items[i].key, pass)];
  }
  for (auto& pass : starts) {
    std::uint32_t sum = 0;
    for (std::uint32_t& start : pass) start = std::exchange(sum, sum + start);
  }
  auto other = std::make_unique_for_overwrite<KeyedIndex[]>(n);
  for (int pass = 0; pass < 2; ++pass) {
    auto& start = starts[static_cast<std::size_t>(pass)];
    for (std::size_t i = 0; i < n; ++i) other[start[digit(items[i].key, pass)]++] = items[i];
    std::swap(items, other);
  }
  other.reset();
  auto sorted = std::make_unique_for_overwrite<std::uint32_t[]>(n);
  for (std::size_t i = 0; i < n; ++i) sorted[starts[2][digit(items[i].key, 2)]++] = items[i].index;
  return sorted;
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

template <class F>
void for_each_range(std::size_t n, int threads, F&& f) {
  if (threads == 1) {
    f(std::size_t{0}, n);
  } else {
    parallel_for_blocks(n, 4096, f);
  }
}

}  // namespace

void fill_records(const Scene& scene, int threads, BoxRecords& records) {
  for_each_range(records.size(), threads, [&](std::size_t begin, std::size_t end) {
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
    auto items = std::make_unique_for_overwrite<KeyedIndex[]>(records.size());
    for (std::size_t i = 0; i < records.size(); ++i) {
      items[i] = {sortable(position(scene, records[i], positions, order / per_axis, order % per_axis == 1)),
                  static_cast<std::uint32_t>(i)};
    }
    lists[static_cast<std::size_t>(order)] = sorted_indices(std::move(items), records.size());
  };
  if (threads == 1) {
    for (int order = 0; order < count(); ++order) sort(order);
    meanwhile();
  } else {
    parallel_for_each(lists.size() + 1, [&](std::size_t i) { i < lists.size() ? sort(static_cast<int>(i)) : meanwhile(); });
  }
}

}  // namespace raystudy::topdown
