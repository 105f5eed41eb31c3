#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "harness/geometry/box.h"
#include "harness/geometry/ray.h"

namespace raystudy::streams {

/// Where rays go, roughly: the octant of their direction and its longest axis, as the watertight test takes it.
struct Sector {
  static constexpr unsigned count = 32;

  unsigned octant;  ///< bit i: downwards along axis i
  unsigned along;
  [[nodiscard]] unsigned index() const { return 4 * octant + along; }
  [[nodiscard]] static Sector at(unsigned index) { return {index / 4, index % 4}; }
  [[nodiscard]] static Sector of(const Ray& ray);
};

/// What rays are sorted by within their sector: cells of origin, and within one of these cells of direction, each along a Morton
/// curve.
struct SortKey {
  unsigned origin_bits = 4;     ///< the scene's box has 2^bits cells along each axis: at most 6
  unsigned direction_bits = 0;  ///< a sector has 2^bits x 2^bits cells: at most 4
};

/// Orders the rays of one block after another; rays with the same key keep their order.
class RaySorter {
 public:
  RaySorter(const Box& bounds, const SortKey& key);

  /// The rays of sector `s` are then order()[begin(s)] to order()[begin(s + 1) - 1].
  void sort(std::span<const Ray> rays);

  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  [[nodiscard]] std::size_t begin(unsigned sector) const { return begin_[sector]; }

 private:
  [[nodiscard]] std::uint32_t key_of(const Ray& ray) const;
  void sort_by_digit(unsigned shift, unsigned bits);

  SortKey key_;
  unsigned bits_;  ///< of a whole key
  Vec3 lower_;
  Vec3 cells_;  ///< a unit of length, along each axis
  std::vector<std::uint32_t> keys_, order_;
  std::vector<std::uint32_t> other_keys_, other_order_;
  std::vector<std::uint32_t> places_;
  std::array<std::size_t, Sector::count + 1> begin_{};
};

}  // namespace raystudy::streams
