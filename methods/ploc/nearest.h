#pragma once

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "harness/method/cost_model.h"
#include "methods/ploc/clusters.h"

// The nearest neighbour of cluster i is the j, up to `radius` places before or behind, for which the measure of the union is
// least; of equal ones the j for which i XOR j is least. By that rule i and i XOR 1 choose each other where all are equal, so
// that such clusters halve their number in a round; by the rule of the lower index they would all choose the one before and form
// a chain. A measure that is no number (of infinities) counts as infinite.

namespace raystudy::ploc {

namespace hn = hwy::HWY_NAMESPACE;

/// Clusters of a multiple of this many places may be searched for apart from the others.
inline constexpr std::size_t search_group = 64;

/// Sets nearest[i] for i in [begin, end), and past `end` up to the next multiple of the vector's length. The areas of all unions
/// must be finite.
inline void find_nearest(const SurfaceArea& /*measure*/, const Clusters& clusters, std::size_t begin, std::size_t end, int radius,
                         std::uint32_t* nearest) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  static_assert(search_group % hn::MaxLanes(hn::ScalableTag<float>()) == 0);
  for (std::size_t i = begin; i < end; i += hn::Lanes(d)) {
    const auto load = [&](std::size_t row, std::ptrdiff_t k) {
      return hn::LoadU(d, clusters.row(row) + static_cast<std::ptrdiff_t>(i) + k);
    };
    const auto lower_x = load(0, 0);
    const auto lower_y = load(1, 0);
    const auto lower_z = load(2, 0);
    const auto upper_x = load(3, 0);
    const auto upper_y = load(4, 0);
    const auto upper_z = load(5, 0);
    const auto places = hn::Iota(di, static_cast<std::int32_t>(i));
    auto least = hn::Set(d, std::numeric_limits<float>::infinity());
    auto least_xor = hn::Set(di, std::numeric_limits<std::int32_t>::max());
    const auto look_at = [&](std::ptrdiff_t k) {
      // Negated extents, whose products are those of the extents; summed as Box::half_area does.
      const auto x = hn::Add(hn::Min(lower_x, load(0, k)), hn::Min(upper_x, load(3, k)));
      const auto y = hn::Add(hn::Min(lower_y, load(1, k)), hn::Min(upper_y, load(4, k)));
      const auto z = hn::Add(hn::Min(lower_z, load(2, k)), hn::Min(upper_z, load(5, k)));
      const auto area = hn::Add(hn::Add(hn::Mul(x, y), hn::Mul(y, z)), hn::Mul(z, x));
      const auto places_xor = hn::Xor(places, hn::Add(places, hn::Set(di, static_cast<std::int32_t>(k))));
      const auto tie = hn::And(hn::Eq(area, least), hn::RebindMask(d, hn::Lt(places_xor, least_xor)));
      const auto nearer = hn::Or(hn::Lt(area, least), tie);
      least = hn::Min(least, area);
      least_xor = hn::IfThenElse(hn::RebindMask(di, nearer), places_xor, least_xor);
    };
    for (std::ptrdiff_t k = 1; k <= radius; ++k) {
      look_at(-k);
      look_at(k);
    }
    hn::StoreU(hn::Xor(places, least_xor), di, reinterpret_cast<std::int32_t*>(nearest) + i);
  }
}

/// The same for any measure, finite or not.
inline void find_nearest(const AnyMeasure& measure, const Clusters& clusters, std::size_t begin, std::size_t end, int radius,
                         std::uint32_t* nearest) {
  const auto reach = static_cast<std::size_t>(radius);
  std::vector<Box> unions(2 * reach + 1);
  std::vector<float> measures(unions.size());
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t first = i - std::min(i, reach);
    const std::size_t last = std::min(i + reach, clusters.count() - 1);
    const Box box = clusters.box(i);
    for (std::size_t j = first; j <= last; ++j) unions[j - first] = united(box, clusters.box(j));
    measure.evaluate({unions.data(), last - first + 1}, {measures.data(), last - first + 1});
    std::size_t best = i;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t j = first; j <= last; ++j) {
      if (j == i) continue;
      const float m = std::isnan(measures[j - first]) ? std::numeric_limits<float>::infinity() : measures[j - first];
      if (best != i && !(m < least || (m == least && (i ^ j) < (i ^ best)))) continue;
      best = j;
      least = m;
    }
    nearest[i] = static_cast<std::uint32_t>(best);
  }
}

}  // namespace raystudy::ploc
