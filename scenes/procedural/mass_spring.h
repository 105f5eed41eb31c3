#pragma once

#include <cstddef>
#include <vector>

#include "harness/geometry/vec3.h"

namespace raystudy::procedural {

/// A ball that does not move, on the ground y = 0: what a cloth falls on.
struct Obstacle {
  Vec3 center;
  float radius = 0;
  float friction = 0.4F;
  float thickness = 0.01F;  ///< cloth keeps so far off
};

/// A square cloth of n × n equal masses on structural, shear and bending springs, as extended position-based dynamics (Macklin,
/// Müller, Chentanez 2016) with one iteration of many small steps (Macklin et al. 2019). Springs are relaxed in groups that share
/// no mass, so that the result is the same whatever the threads.
class MassSpringCloth {
 public:
  /// `positions` by rows; rest lengths are those of a flat cloth of that side.
  MassSpringCloth(std::vector<Vec3> positions, int n, float side);

  void step(float dt, const Obstacle& obstacle);
  [[nodiscard]] const std::vector<Vec3>& positions() const { return positions_; }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(column);
  }
  void relax_all(float dt);
  void relax(int row_step, int column_step, float compliance, float dt);

  int n_;
  float cell_;
  std::vector<Vec3> positions_;
  std::vector<Vec3> before_;
  std::vector<Vec3> velocities_;
};

}  // namespace raystudy::procedural
