#pragma once

#include <limits>

#include "harness/geometry/vec3.h"

namespace raystudy {

/// An axis-aligned bounding box. The default is the empty box, the neutral element of `extend`.
struct Box {
  Vec3 lower{std::numeric_limits<float>::infinity()};
  Vec3 upper{-std::numeric_limits<float>::infinity()};

  constexpr Box() = default;
  constexpr Box(Vec3 lower_, Vec3 upper_) : lower(lower_), upper(upper_) {}

  constexpr void extend(Vec3 p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  constexpr void extend(const Box& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  [[nodiscard]] constexpr bool is_empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  [[nodiscard]] constexpr Vec3 extent() const { return upper - lower; }
  [[nodiscard]] constexpr Vec3 center() const { return (lower + upper) * 0.5F; }
  /// Half the surface area; 0 for the empty box. Heuristics compare areas only, so the factor 2 is left out everywhere.
  [[nodiscard]] constexpr float half_area() const {
    if (is_empty()) return 0;
    const Vec3 e = extent();
    return e.x * e.y + e.y * e.z + e.z * e.x;
  }
  [[nodiscard]] constexpr bool contains(const Box& b) const {
    return lower.x <= b.lower.x && lower.y <= b.lower.y && lower.z <= b.lower.z && b.upper.x <= upper.x && b.upper.y <= upper.y &&
           b.upper.z <= upper.z;
  }
  /// Whether the closed boxes have a point in common.
  [[nodiscard]] constexpr bool overlaps(const Box& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y && lower.z <= b.upper.z &&
           b.lower.z <= upper.z;
  }
  [[nodiscard]] int longest_axis() const {
    const Vec3 e = extent();
    if (e.x >= e.y && e.x >= e.z) return 0;
    return e.y >= e.z ? 1 : 2;
  }
  friend constexpr bool operator==(const Box&, const Box&) = default;
};
static_assert(sizeof(Box) == 24);

constexpr Box united(Box a, const Box& b) {
  a.extend(b);
  return a;
}

}  // namespace raystudy
