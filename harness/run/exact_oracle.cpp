#include "harness/run/exact_oracle.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace raystudy {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactPoint = Kernel::Point_3;
using ExactVector = Kernel::Vector_3;

struct Vec3d {
  double x, y, z;
  Vec3d(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  explicit Vec3d(Vec3 v) : x(v.x), y(v.y), z(v.z) {}
};
Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec3d operator*(double s, Vec3d a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec3d cross(Vec3d a, Vec3d b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Vec3d a) { return std::sqrt(dot(a, a)); }

struct Corners {
  Vec3d a, b, c;
  Corners(const Scene& scene, std::uint32_t t)
      : a(scene.vertices[scene.triangles[t][0]]),
        b(scene.vertices[scene.triangles[t][1]]),
        c(scene.vertices[scene.triangles[t][2]]) {}
};

double distance_to_segment(Vec3d p, Vec3d a, Vec3d b) {
  const Vec3d ab = b - a;
  const double square = dot(ab, ab);
  const double s = square > 0 ? std::clamp(dot(p - a, ab) / square, 0.0, 1.0) : 0.0;
  return length(p - (a + s * ab));
}

double distance_to_triangle(Vec3d p, const Corners& t) {
  double distance =
      std::min({distance_to_segment(p, t.a, t.b), distance_to_segment(p, t.b, t.c), distance_to_segment(p, t.c, t.a)});
  const Vec3d n = cross(t.b - t.a, t.c - t.a);
  const double size = length(n);
  const bool above = size > 0 && dot(cross(t.b - t.a, p - t.a), n) >= 0 && dot(cross(t.c - t.b, p - t.b), n) >= 0 &&
                     dot(cross(t.a - t.c, p - t.c), n) >= 0;
  if (above) distance = std::min(distance, std::fabs(dot(p - t.a, n)) / size);
  return distance;
}

/// A ray in exact arithmetic, with its origin displaced by `offset`.
struct ExactRay {
  ExactPoint origin;
  ExactVector direction;
  ExactRay(const Ray& ray, Vec3d offset)
      : origin(ExactPoint(ray.origin.x, ray.origin.y, ray.origin.z) + ExactVector(offset.x, offset.y, offset.z)),
        direction(ray.direction.x, ray.direction.y, ray.direction.z) {}
};

/// t where the line meets the triangle, its edges and corners included; nothing for a triangle seen edge-on or of no area.
std::optional<Kernel::FT> exact_t(const ExactRay& ray, const Scene& scene, std::uint32_t triangle) {
  const auto corner = [&](int i) {
    const Vec3 v = scene.vertices[scene.triangles[triangle][i]];
    return ExactPoint(v.x, v.y, v.z) - ray.origin;
  };
  const std::array<ExactVector, 3> p{corner(0), corner(1), corner(2)};
  bool positive = false;
  bool negative = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const CGAL::Sign sign = CGAL::sign(CGAL::determinant(ray.direction, p[i], p[(i + 1) % 3]));
    positive = positive || sign == CGAL::POSITIVE;
    negative = negative || sign == CGAL::NEGATIVE;
  }
  if (positive == negative) return {};  // outside, or all in one plane
  const ExactVector normal = CGAL::cross_product(p[1] - p[0], p[2] - p[0]);
  const Kernel::FT slope = normal * ray.direction;
  if (CGAL::is_zero(slope)) return {};
  return (normal * p[0]) / slope;
}

/// Rounded once: without asking for the exact value first, CGAL is content with a relative error of 1e-5.
double rounded(const Kernel::FT& x) { return CGAL::to_double(x.exact()); }

/// The nearest t that is certainly in the range, and the nearest that may be, where the range's ends are off by `slack`.
struct Outcome {
  double certain = std::numeric_limits<double>::infinity();
  double possible = std::numeric_limits<double>::infinity();
};

Outcome outcome(const ExactRay& exact, const Ray& ray, const Scene& scene, const std::vector<std::uint32_t>& triangles,
                double slack) {
  Outcome result;
  for (const std::uint32_t t : triangles) {
    const auto hit = exact_t(exact, scene, t);
    if (!hit) continue;
    const double at = rounded(*hit);
    if (at >= ray.tmin - slack && at <= ray.tmax + slack) result.possible = std::min(result.possible, at);
    if (at >= ray.tmin + slack && at <= ray.tmax - slack) result.certain = std::min(result.certain, at);
  }
  return result;
}

/// True where the ray passes within `distance` of one of a triangle's edges, at a t within its range or `slack` of it.
bool passes_edge(const Ray& ray, const Corners& triangle, double distance, double slack) {
  const Vec3d d(ray.direction);
  const double square = dot(d, d);
  // Across the ray, its origin at zero.
  const auto across = [&](Vec3d p) { return p - (dot(p, d) / square) * d; };
  const std::array<Vec3d, 3> corners{triangle.a - Vec3d(ray.origin), triangle.b - Vec3d(ray.origin),
                                     triangle.c - Vec3d(ray.origin)};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3d p = corners[i];
    const Vec3d edge = corners[(i + 1) % 3] - p;
    const Vec3d flat = across(edge);
    const double size = dot(flat, flat);
    const double s = size > 0 ? std::clamp(-dot(across(p), flat) / size, 0.0, 1.0) : 0.0;
    const Vec3d nearest = p + s * edge;
    const double t = dot(nearest, d) / square;
    if (length(across(nearest)) <= distance && t >= ray.tmin - slack && t <= ray.tmax + slack) return true;
  }
  return false;
}

/// Offsets across a direction: none, then 16 on the circle of radius δ and 8 on that of δ / 3.
std::vector<Vec3d> offsets_across(Vec3 direction, double delta) {
  const Vec3d d = (1 / length(Vec3d(direction))) * Vec3d(direction);
  const Vec3d helper = std::fabs(d.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
  const Vec3d u = (1 / length(cross(d, helper))) * cross(d, helper);
  const Vec3d v = cross(d, u);
  std::vector<Vec3d> offsets{{0, 0, 0}};
  for (int i = 0; i < 24; ++i) {
    const double radius = i < 16 ? delta : delta / 3;
    const double angle = 2 * std::numbers::pi * (i < 16 ? i / 16.0 : (i + 0.5) / 8.0);
    offsets.push_back(radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return offsets;
}

bool is_traceable(const Ray& ray) {
  return is_finite(ray.origin) && is_finite(ray.direction) && ray.direction != Vec3{} && ray.tmin >= 0 && ray.tmin <= ray.tmax;
}

double reach(const Box& box, Vec3 origin) {
  double farthest = 0;
  for (int i = 0; i < 3; ++i) {
    farthest = std::max(
        {farthest, std::fabs(double{box.lower[i]} - double{origin[i]}), std::fabs(double{box.upper[i]} - double{origin[i]})});
  }
  return farthest;
}

/// True unless the ray certainly stays farther than `margin` from the box. Doubles are exact to 2⁻⁵³; a share of 2⁻⁴⁰ of the
/// distance is added to the margin for their rounding.
bool may_meet(const Ray& ray, const Box& box, double margin) {
  const double grown = margin + reach(box, ray.origin) * 0x1p-40;
  double near = 0;
  double far = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const double lower = double{box.lower[i]} - grown - double{ray.origin[i]};
    const double upper = double{box.upper[i]} + grown - double{ray.origin[i]};
    const double d = ray.direction[i];
    if (d == 0) {
      if (lower > 0 || upper < 0) return false;
      continue;
    }
    near = std::max(near, (d > 0 ? lower : upper) / d);
    far = std::min(far, (d > 0 ? upper : lower) / d);
  }
  return near * (1 - 0x1p-40) <= far * (1 + 0x1p-40) &&
         near * (1 - 0x1p-40) <= double{ray.tmax} + margin / length(Vec3d(ray.direction));
}

}  // namespace

ExactOracle::ExactOracle(const Scene& scene) : scene_(scene), blocks_((scene.triangles.size() + block_size - 1) / block_size) {
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t) blocks_[t / block_size].extend(scene.triangle_box(t));
}

std::vector<std::uint32_t> ExactOracle::candidates(const Ray& ray, double margin) const {
  std::vector<std::uint32_t> found;
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    if (!may_meet(ray, blocks_[block], margin)) continue;
    const auto begin = static_cast<std::uint32_t>(block * block_size);
    const auto end = static_cast<std::uint32_t>(std::min<std::size_t>(begin + block_size, scene_.triangles.size()));
    for (std::uint32_t t = begin; t < end; ++t) {
      if (may_meet(ray, scene_.triangle_box(t), margin)) found.push_back(t);
    }
  }
  return found;
}

ExactHit ExactOracle::closest(const Ray& ray) const {
  ExactHit best;
  if (!is_traceable(ray)) return best;
  const ExactRay exact(ray, {0, 0, 0});
  std::optional<Kernel::FT> nearest;
  for (const std::uint32_t t : candidates(ray, 0)) {
    const auto hit = exact_t(exact, scene_, t);
    if (!hit || *hit < Kernel::FT(ray.tmin)) continue;
    if (std::isfinite(ray.tmax) && *hit > Kernel::FT(ray.tmax)) continue;
    if (nearest && *hit >= *nearest) continue;
    nearest = hit;
    best = {rounded(*hit), t};
  }
  return best;
}

double ExactOracle::tolerance(const Ray& ray, std::uint32_t a, std::uint32_t b) const {
  double farthest = 0;
  for (const std::uint32_t t : {a, b}) {
    if (t != no_hit) farthest = std::max(farthest, reach(scene_.triangle_box(t), ray.origin));
  }
  if (a == no_hit && b == no_hit) farthest = reach(scene_.bounds, ray.origin);
  // Below 2⁻¹²⁶ floats round by a fixed step.
  return 32 * 0x1p-24 * farthest + 32 * 0x1p-149;
}

bool ExactOracle::is_on_triangle(const Ray& ray, const Hit& hit, double distance) const {
  const Vec3d point = Vec3d(ray.origin) + double{hit.t} * Vec3d(ray.direction);
  return distance_to_triangle(point, Corners(scene_, hit.triangle)) <= distance;
}

bool ExactOracle::weights_are_right(const Ray& ray, const Hit& hit, double distance) const {
  const Corners t(scene_, hit.triangle);
  const Vec3d point = t.a + double{hit.u} * (t.b - t.a) + double{hit.v} * (t.c - t.a);
  const Vec3d d(ray.direction);
  const double off = length(cross(point - Vec3d(ray.origin), d)) / length(d);
  // Weights are quotients of areas: for a triangle of longest edge e and height h they are off by some ulp times e / h, which
  // moves the point by e²/h ulp. A triangle seen edge-on or without height has no weights to speak of.
  const double longest = std::max({length(t.b - t.a), length(t.c - t.b), length(t.a - t.c)});
  const double height = std::fabs(dot(cross(t.b - t.a, t.c - t.a), d)) / (longest * length(d));
  return !(off > distance + 0x1p-20 * longest * longest / height);
}

ExactOracle::Verdict ExactOracle::judge(const Ray& ray, const Hit& found, Query query, const Hit& other) const {
  Verdict verdict;
  verdict.exact = closest(ray);
  if (!is_traceable(ray)) {
    verdict.judgement = found.is_hit() ? Judgement::wrong : Judgement::right;
    return verdict;
  }
  if (found.is_hit() && found.triangle >= scene_.triangles.size()) return verdict;
  const bool names_triangle = found.is_hit() && query == Query::closest_hit;
  const std::uint32_t third = other.is_hit() && query == Query::closest_hit ? other.triangle : no_hit;
  const double delta = std::max(tolerance(ray, names_triangle ? found.triangle : verdict.exact.triangle, third),
                                verdict.exact.triangle == no_hit ? 0 : tolerance(ray, verdict.exact.triangle));
  const double slack = 4 * delta / length(Vec3d(ray.direction));
  if (names_triangle && !(found.t >= ray.tmin && found.t <= ray.tmax && is_on_triangle(ray, found, 2 * delta) &&
                          weights_are_right(ray, found, 2 * delta))) {
    return verdict;
  }
  const std::vector<std::uint32_t> triangles = candidates(ray, 2 * delta);
  const std::vector<Vec3d> offsets = offsets_across(ray.direction, delta);
  // Thinner triangles than the displaced rays are apart.
  if (found.is_hit() && !names_triangle && std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
        return passes_edge(ray, Corners(scene_, t), delta, slack);
      })) {
    verdict.judgement = Judgement::right;
    return verdict;
  }
  // Whether `found` can stand beside what a displaced ray, or a scene with gaps, meets.
  const auto fits = [&](const Outcome& o) {
    if (!found.is_hit()) return std::isinf(o.certain);
    if (!names_triangle) return std::isfinite(o.possible);
    return o.certain >= double{found.t} - slack;
  };
  for (const Vec3d& offset : offsets) {
    if (!fits(outcome(ExactRay(ray, offset), ray, scene_, triangles, slack))) continue;
    verdict.judgement = Judgement::right;
    return verdict;
  }
  std::vector<std::uint32_t> met_inside = triangles;
  for (const Vec3d& offset : offsets) {
    const ExactRay exact(ray, offset);
    std::erase_if(met_inside, [&](std::uint32_t t) { return !exact_t(exact, scene_, t); });
  }
  const bool lost = !found.is_hit() || names_triangle;
  if (lost && fits(outcome(ExactRay(ray, {0, 0, 0}), ray, scene_, met_inside, slack))) verdict.judgement = Judgement::leak;
  return verdict;
}

}  // namespace raystudy
