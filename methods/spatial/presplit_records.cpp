#include "methods/spatial/presplit_records.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "methods/spatial/slicer.h"
#include "methods/topdown/record_passes.h"
#include "methods/topdown/sweep_orders.h"

namespace raystudy::spatial {
namespace {

using Doubles = std::array<double, 3>;

Doubles doubles(Vec3 v) { return {v.x, v.y, v.z}; }
Doubles difference(Vec3 a, Vec3 b) {
  return {static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y, static_cast<double>(a.z) - b.z};
}

/// In double, since floats may have no such product.
double surface_area_of(const Box& box) {
  const Doubles e = difference(box.upper, box.lower);
  return 2 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
}

double longest_extent(const Box& box) {
  const Doubles e = difference(box.upper, box.lower);
  return std::max({e[0], e[1], e[2]});
}

/// Splits triangles into parts.
class Splitter {
 public:
  Splitter(const Scene& scene, const MedianPlanes& planes) : scene_(scene), planes_(planes) {}

  /// Writes up to 1 + `splits` parts and returns where they end.
  BoxRecord* split(BoxRecord part, std::uint32_t splits, BoxRecord* to) const {
    while (splits > 0) {
      const auto plane = planes_.most_important(WideBox::of(part).box());
      if (plane.axis < 0) break;
      const auto sides = chopped(scene_, part, plane.axis, plane.at);
      const bool on_left = !sides[0].is_empty();
      const bool on_right = !sides[1].is_empty();
      if (on_left && on_right) {
        --splits;
        const double left = longest_extent(sides[0].box());
        const double right = longest_extent(sides[1].box());
        const auto share = static_cast<std::uint32_t>(std::floor(splits * (left / (left + right)) + 0.5));
        to = split(record_of(sides[0], part), share, to);
        part = record_of(sides[1], part);
        splits -= share;
      } else if (on_left || on_right) {
        part = record_of(sides[on_left ? 0 : 1], part);  // the box was too large, and nothing had to be split
      } else {
        break;
      }
    }
    *to = part;
    return to + 1;
  }

 private:
  static BoxRecord record_of(const WideBox& box, const BoxRecord& whole) {
    BoxRecord record;
    box.store(record);
    record.triangle = whole.triangle;
    record.rank = whole.rank;
    return record;
  }

  const Scene& scene_;
  const MedianPlanes& planes_;
};

std::uint64_t budget_of(std::size_t triangles, double budget) {
  const double most = static_cast<double>(std::numeric_limits<std::int32_t>::max()) - static_cast<double>(triangles);
  return static_cast<std::uint64_t>(std::clamp(static_cast<double>(triangles) * budget, 0.0, std::max(most, 0.0)));
}

std::uint64_t sum_of_splits(std::span<const float> priorities, float scale, int threads) {
  std::atomic<std::uint64_t> sum{0};
  parallel_for_blocks(priorities.size(), 32768, threads, [&](std::size_t begin, std::size_t end) {
    std::uint64_t part = 0;
    for (std::size_t i = begin; i < end; ++i) part += split_count(scale, priorities[i]);
    sum += part;
  });
  return sum;
}

}  // namespace

MedianPlanes::MedianPlanes(const Box& scene) : lower_(doubles(scene.lower)), surface_area_(surface_area_of(scene)) {
  const Doubles extent = difference(scene.upper, scene.lower);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    cell_[axis] = std::ldexp(extent[axis], -levels);
    per_unit_[axis] = extent[axis] > 0 ? 1 / cell_[axis] : 0;
  }
}

MedianPlanes::Plane MedianPlanes::most_important(const Box& box) const {
  Plane best;
  double best_extent = 0;
  const Doubles extent = difference(box.upper, box.lower);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    const auto cells = [&](float x) { return (x - lower_[axis]) * per_unit_[axis]; };
    // The first and the last cell between the planes of the last level; what ends at a plane does not reach beyond.
    const auto first = static_cast<std::int32_t>(cells(box.lower[a]));
    const std::int32_t last = static_cast<std::int32_t>(std::ceil(cells(box.upper[a]))) - 1;
    if (first >= last) continue;
    // The planes of a level part cells that differ in one digit.
    const int digit = std::bit_width(static_cast<std::uint32_t>(first ^ last)) - 1;
    const int level = levels - 1 - digit;
    if (best.axis >= 0 && (level > best.level || (level == best.level && extent[axis] <= best_extent))) continue;
    const auto at = static_cast<float>(lower_[axis] + cell_[axis] * ((last >> digit) << digit));
    if (!(box.lower[a] < at && at < box.upper[a])) continue;  // floats are too coarse for it
    best = {a, level, at};
    best_extent = extent[axis];
  }
  return best;
}

float split_priority(const Scene& scene, const MedianPlanes& planes, const BoxRecord& record) {
  const Box box = WideBox::of(record).box();
  const auto plane = planes.most_important(box);
  if (plane.axis < 0) return 0;
  const Triangle& t = scene.triangles[record.triangle];
  const Vec3 corner = scene.vertices[t[0]];
  const Doubles u = difference(scene.vertices[t[1]], corner);
  const Doubles v = difference(scene.vertices[t[2]], corner);
  const double ideal =
      std::abs(u[1] * v[2] - u[2] * v[1]) + std::abs(u[2] * v[0] - u[0] * v[2]) + std::abs(u[0] * v[1] - u[1] * v[0]);
  const double surplus = surface_area_of(box) - ideal;
  if (!(surplus > 0)) return 0;
  return std::cbrt(static_cast<float>(std::ldexp(surplus / planes.surface_area(), -plane.level)));
}

float split_scale(std::span<const float> priorities, std::uint64_t budget, int threads) {
  // Positive floats are in the order of their bits, so that bisection ends after 31 steps.
  auto within = std::bit_cast<std::uint32_t>(0.0F);
  auto beyond = std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity());
  while (beyond - within > 1) {
    const std::uint32_t middle = within + (beyond - within) / 2;
    const std::uint64_t splits = sum_of_splits(priorities, std::bit_cast<float>(middle), threads);
    (splits <= budget ? within : beyond) = middle;
    if (splits == budget) break;
  }
  return std::bit_cast<float>(within);
}

PresplitRecords::PresplitRecords(const Scene& scene, double budget, int threads)
    : room_(scene.triangles.size() + budget_of(scene.triangles.size(), budget)), count_(scene.triangles.size()) {
  const std::uint64_t splits = room_.size() - count_;
  if (splits == 0) {
    topdown::fill_records(scene, threads, {room_.data(), count_});
  } else {
    split(scene, splits, threads);
  }
}

void PresplitRecords::split(const Scene& scene, std::uint64_t budget, int threads) {
  const std::size_t n = scene.triangles.size();
  topdown::BoxRecords whole(n);
  topdown::fill_records(scene, threads, {whole.data(), n});
  const MedianPlanes planes(topdown::bounds_of({whole.data(), n}, threads).box.box());
  std::vector<float> priorities(n);
  parallel_for_blocks(n, 4096, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) priorities[i] = split_priority(scene, planes, whole[i]);
  });
  const float scale = split_scale(priorities, budget, threads);

  // Blocks of triangles write their parts where those begin if every split is made.
  constexpr std::size_t block = 4096;
  const std::size_t blocks = (n + block - 1) / block;
  std::vector<std::span<BoxRecord>> parts(blocks);
  BoxRecord* next = room_.data();
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t begin = b * block;
    const std::span<const float> own{&priorities[begin], std::min(block, n - begin)};
    const std::size_t most = own.size() + sum_of_splits(own, scale, 1);
    parts[b] = {next, most};
    next += most;
  }
  const Splitter splitter(scene, planes);
  parallel_for_blocks(blocks, 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t b = first; b < last; ++b) {
      BoxRecord* to = parts[b].data();
      for (std::size_t i = b * block; i < std::min(n, (b + 1) * block); ++i) {
        to = splitter.split(whole[i], split_count(scale, priorities[i]), to);
      }
      parts[b] = parts[b].first(static_cast<std::size_t>(to - parts[b].data()));
    }
  });
  next = room_.data();
  for (const auto& made : parts) next = made.data() == next ? next + made.size() : std::copy(made.begin(), made.end(), next);
  count_ = static_cast<std::size_t>(next - room_.data());
}

}  // namespace raystudy::spatial
