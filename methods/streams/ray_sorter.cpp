#include "methods/streams/ray_sorter.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace raystudy::streams {
namespace {

/// floor(x) within [0, n); 0 for what is no number.
std::uint32_t cell_of(float x, float n) { return static_cast<std::uint32_t>(std::min(std::max(0.0F, x), n - 1)); }

/// Bit i of each of the first 8 bits goes to bit `apart` · i.
template <unsigned apart>
constexpr std::array<std::uint32_t, 256> spread_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t x = 0; x < 256; ++x) {
    for (unsigned i = 0; i < 8; ++i) table[x] |= ((x >> i) & 1U) << (apart * i);
  }
  return table;
}

constexpr unsigned sector_bits = 5;

constexpr auto every_second = spread_table<2>();
constexpr auto every_third = spread_table<3>();

}  // namespace

Sector Sector::of(const Ray& ray) {
  const auto sign = [&](int i) { return std::bit_cast<std::uint32_t>(ray.direction[i]) >> 31U; };
  const float x = std::fabs(ray.direction.x);
  const float y = std::fabs(ray.direction.y);
  const float z = std::fabs(ray.direction.z);
  // x > y, y > z, x > z: together they say which is the longest. By a table, since branches could not be predicted.
  static constexpr std::array<std::uint8_t, 8> longest{2, 2, 1, 2, 2, 0, 1, 0};
  const unsigned order =
      static_cast<unsigned>(x > y) | (static_cast<unsigned>(y > z) << 1U) | (static_cast<unsigned>(x > z) << 2U);
  return {sign(0) | (sign(1) << 1U) | (sign(2) << 2U), longest[order]};
}

RaySorter::RaySorter(const Box& bounds, const SortKey& key)
    : key_(key), bits_(sector_bits + 2 * key.direction_bits + 3 * key.origin_bits), lower_(bounds.lower) {
  const Vec3 extent = bounds.extent();
  for (int i = 0; i < 3; ++i) cells_[i] = extent[i] > 0 ? static_cast<float>(1U << key.origin_bits) / extent[i] : 0;
}

std::uint32_t RaySorter::key_of(const Ray& ray) const {
  const Sector sector = Sector::of(ray);
  std::uint32_t direction = 0;
  std::uint32_t origin = 0;
  if (key_.direction_bits > 0) {
    const auto n = static_cast<float>(1U << key_.direction_bits);
    static constexpr std::array<std::uint8_t, 5> cycle{0, 1, 2, 0, 1};
    const auto size = [&](unsigned axis) { return std::fabs((&ray.direction.x)[cycle[axis]]); };
    const float scale = n / size(sector.along);
    direction = every_second[cell_of(size(sector.along + 1) * scale, n)] |
                (every_second[cell_of(size(sector.along + 2) * scale, n)] << 1U);
  }
  if (key_.origin_bits > 0) {
    const auto n = static_cast<float>(1U << key_.origin_bits);
    for (int i = 0; i < 3; ++i) {
      origin |= every_third[cell_of((ray.origin[i] - lower_[i]) * cells_[i], n)] << static_cast<unsigned>(i);
    }
  }
  return (((sector.index() << (3 * key_.origin_bits)) | origin) << (2 * key_.direction_bits)) | direction;
}

void RaySorter::sort(std::span<const Ray> rays) {
  keys_.resize(rays.size());
  order_.resize(rays.size());
  other_keys_.resize(rays.size());
  other_order_.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    keys_[i] = key_of(rays[i]);
    order_[i] = static_cast<std::uint32_t>(i);
  }
  const unsigned passes = (bits_ + 10) / 11;
  const unsigned digit = (bits_ + passes - 1) / passes;
  for (unsigned shift = 0; shift < bits_; shift += digit) sort_by_digit(shift, std::min(digit, bits_ - shift));
  begin_.fill(rays.size());
  for (std::size_t i = rays.size(); i-- > 0;) begin_[keys_[i] >> (bits_ - sector_bits)] = i;
  for (unsigned s = Sector::count; s-- > 0;) begin_[s] = std::min(begin_[s], begin_[s + 1]);
}

/// A stable counting sort.
void RaySorter::sort_by_digit(unsigned shift, unsigned bits) {
  const std::uint32_t mask = (1U << bits) - 1;
  places_.assign(std::size_t{mask} + 2, 0);
  for (const std::uint32_t key : keys_) ++places_[((key >> shift) & mask) + 1];
  for (std::size_t i = 1; i < places_.size(); ++i) places_[i] += places_[i - 1];
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const std::uint32_t to = places_[(keys_[i] >> shift) & mask]++;
    other_keys_[to] = keys_[i];
    other_order_[to] = order_[i];
  }
  keys_.swap(other_keys_);
  order_.swap(other_order_);
}

}  // namespace raystudy::streams
