#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "harness/geometry/box.h"
#include "harness/geometry/ray.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// Where a ray meets the scene by exact arithmetic: t rounded once to double, infinity for a miss.
struct ExactHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = no_hit;
};

/// Decides whether a hit is right by exact arithmetic over the scene's triangles (CGAL's exact kernel), found by a conservative
/// box filter in double precision and nothing that a tracer uses.
///
/// What right means. A tracer computes in floats, so its best answer is the exact one for a ray and triangles displaced by their
/// rounding: by δ = 32 · 2⁻²⁴ · R, where R is the distance (largest coordinate difference) from the ray's origin to the farthest
/// corner of the triangles in question. A sheared corner is off by at most 5 · 2⁻²⁴ R (Woop, Benthin, Wald 2013, section 4); edge
/// functions by Plücker coordinates, as in Embree, multiply an edge with the sum of its corners, up to 2 R long, in some seven
/// roundings over three coordinates, which displaces the ray by up to 24 · 2⁻²⁴ R. The ray itself and 24 parallel rays within δ
/// of it are intersected exactly:
/// - a miss is right where one of them misses: at an open edge or a silhouette, but never at an edge shared by two triangles that
///   cover both its sides, where all of them hit;
/// - a hit of an any-hit query is right where one of them hits, or the ray passes an edge within δ;
/// - a closest hit is right where the point at t lies within 2 δ of the triangle it names, u and v name a point within the
/// rounding
///   of a triangle's shape of the ray, and one of the rays meets nothing nearer.
/// Ends of the ray's range are open by δ as well.
class ExactOracle {
 public:
  explicit ExactOracle(const Scene& scene);

  [[nodiscard]] std::size_t triangle_count() const { return scene_.triangles.size(); }

  enum class Judgement : unsigned char {
    right,
    leak,  ///< wrong, but right if the triangles that the ray meets within δ of their edges were not there: it slipped between
           ///< them
    wrong
  };
  struct Verdict {
    Judgement judgement = Judgement::wrong;
    ExactHit exact;  ///< of the ray itself, by its range to the letter
  };
  /// `other`, where it is a hit, adds its triangle to those in question.
  [[nodiscard]] Verdict judge(const Ray& ray, const Hit& found, Query query, const Hit& other = {}) const;

  /// The closest exact intersection within the ray's range.
  [[nodiscard]] ExactHit closest(const Ray& ray) const;

  /// δ for this ray and these triangles (indices that are no_hit are left out; the whole scene where all are).
  [[nodiscard]] double tolerance(const Ray& ray, std::uint32_t a, std::uint32_t b = no_hit) const;
  /// True where the point at `hit.t` of the ray lies within `distance` of the hit's triangle.
  [[nodiscard]] bool is_on_triangle(const Ray& ray, const Hit& hit, double distance) const;

 private:
  [[nodiscard]] std::vector<std::uint32_t> candidates(const Ray& ray, double margin) const;
  [[nodiscard]] bool weights_are_right(const Ray& ray, const Hit& hit, double distance) const;

  static constexpr std::uint32_t block_size = 32;
  const Scene& scene_;
  std::vector<Box> blocks_;  ///< of each 32 consecutive triangles: files keep neighbours together
};

}  // namespace raystudy
