#pragma once

#include <cstdint>

#include "scenes/procedural/mesh.h"
#include "scenes/procedural/random.h"

namespace raystudy::procedural {

/// How finely a scene's parts are divided. Each part rounds its number of cells up or down by a draw of its own, so that the
/// scene's triangle count is nearly a continuous function of `density` although many parts are alike.
class Detail {
 public:
  Detail(double density, std::uint64_t seed) : density_(density), random_(seed, 0xde7a11) {}

  /// About weight · density cells, at least `least`.
  int cells(double weight, int least) {
    const auto n = static_cast<int>(weight * density_ + random_.uniform());
    return n < least ? least : n;
  }

 private:
  double density_;
  Random random_;
};

/// The mesh of build(mesh, density) whose triangle count is nearest to `triangles`: bisects the density on counting meshes, which
/// cost no memory, and fills once.
template <class Build>
Mesh build_to_count(std::int64_t triangles, Build&& build) {
  const auto counted = [&](double density) {
    Mesh mesh(true);
    build(mesh, density);
    return mesh;
  };
  double low = 0;
  double high = 1;
  while (counted(high).triangle_count() < triangles) high *= 2;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (counted(middle).triangle_count() < triangles ? low : high) = middle;
  }
  const std::int64_t below = triangles - counted(low).triangle_count();
  const std::int64_t above = counted(high).triangle_count() - triangles;
  const double density = below < above ? low : high;
  Mesh mesh = Mesh::sized_as(counted(density));
  build(mesh, density);
  return mesh;
}

}  // namespace raystudy::procedural
