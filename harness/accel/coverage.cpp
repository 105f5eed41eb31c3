#include "harness/accel/coverage.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace raystudy {
namespace {

using Point = std::array<double, 3>;
using Polygon = std::vector<Point>;  // convex

/// A part of the triangle that is still to be found covered, and the boxes that may do so.
struct Part {
  Polygon polygon;
  std::vector<Box> boxes;
};

struct Bounds {
  Point lower;
  Point upper;

  explicit Bounds(const Polygon& polygon) : lower(polygon.front()), upper(polygon.front()) {
    for (const Point& p : polygon) {
      for (std::size_t i = 0; i < 3; ++i) {
        lower[i] = std::min(lower[i], p[i]);
        upper[i] = std::max(upper[i], p[i]);
      }
    }
  }
  [[nodiscard]] bool inside(const Box& b) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<int>(i);
      if (lower[i] < static_cast<double>(b.lower[axis]) || upper[i] > static_cast<double>(b.upper[axis])) return false;
    }
    return true;
  }
  /// Whether the box holds more than a face of these bounds. Where they are flat, a face is all of them.
  [[nodiscard]] bool meets(const Box& b) const {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto from = static_cast<double>(b.lower[static_cast<int>(i)]);
      const auto to = static_cast<double>(b.upper[static_cast<int>(i)]);
      if (lower[i] == upper[i] ? (lower[i] < from || upper[i] > to) : (from >= upper[i] || to <= lower[i])) return false;
    }
    return true;
  }
};

struct Plane {
  std::size_t axis = 3;
  double at = 0;
};

/// The face strictly within the bounds that is nearest to their middle, so that few cuts are needed; axis 3: there is none.
Plane middle_face(const Bounds& bounds, const std::vector<Box>& boxes) {
  Plane best;
  double least = std::numeric_limits<double>::infinity();
  for (const Box& box : boxes) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const Vec3& corner : {box.lower, box.upper}) {
        const auto at = static_cast<double>(corner[static_cast<int>(axis)]);
        if (!(at > bounds.lower[axis] && at < bounds.upper[axis])) continue;
        const double extent = bounds.upper[axis] - bounds.lower[axis];
        const double distance = std::abs((at - bounds.lower[axis]) / extent - 0.5);
        if (distance < least) {
          least = distance;
          best = {axis, at};
        }
      }
    }
  }
  return best;
}

Point cut_edge(const Point& a, const Point& b, const Plane& plane) {
  const double t = (plane.at - a[plane.axis]) / (b[plane.axis] - a[plane.axis]);
  Point p{};
  for (std::size_t i = 0; i < 3; ++i) p[i] = std::clamp(a[i] + t * (b[i] - a[i]), std::min(a[i], b[i]), std::max(a[i], b[i]));
  p[plane.axis] = plane.at;
  return p;
}

/// The parts below and above a plane that has points of the polygon strictly on both sides.
std::pair<Polygon, Polygon> cut(const Polygon& polygon, const Plane& plane) {
  std::pair<Polygon, Polygon> halves;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const double from = a[plane.axis] - plane.at;
    const double to = b[plane.axis] - plane.at;
    if (from <= 0) halves.first.push_back(a);
    if (from >= 0) halves.second.push_back(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) {
      // In one order for both polygons that share the edge.
      const Point p = a < b ? cut_edge(a, b, plane) : cut_edge(b, a, plane);
      halves.first.push_back(p);
      halves.second.push_back(p);
    }
  }
  return halves;
}

Point as_point(Vec3 v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }

}  // namespace

bool boxes_cover(std::span<const Box> boxes, const std::array<Vec3, 3>& triangle) {
  std::vector<Part> parts;
  parts.push_back({{as_point(triangle[0]), as_point(triangle[1]), as_point(triangle[2])}, {boxes.begin(), boxes.end()}});
  while (!parts.empty()) {
    Part part = std::move(parts.back());
    parts.pop_back();
    const Bounds bounds(part.polygon);
    const auto inside = [&](const Box& box) { return bounds.inside(box); };
    if (std::any_of(part.boxes.begin(), part.boxes.end(), inside)) continue;
    part.boxes.erase(std::remove_if(part.boxes.begin(), part.boxes.end(), [&](const Box& box) { return !bounds.meets(box); }),
                     part.boxes.end());
    const Plane plane = middle_face(bounds, part.boxes);
    if (plane.axis == 3) return false;
    auto [below, above] = cut(part.polygon, plane);
    parts.push_back({std::move(below), part.boxes});
    parts.push_back({std::move(above), std::move(part.boxes)});
  }
  return true;
}

}  // namespace raystudy
