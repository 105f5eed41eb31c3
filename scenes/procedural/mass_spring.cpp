#include "scenes/procedural/mass_spring.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "harness/base/parallel.h"

namespace raystudy::procedural {
namespace {

constexpr float gravity = 9.81F;
constexpr std::size_t least_rows = 16;  // a thread's share

void collide(Vec3& p, Vec3 before, const Obstacle& obstacle) {
  const auto rub = [&](Vec3 normal, float depth) {
    p += normal * depth;
    const Vec3 moved = p - before;
    const Vec3 sliding = moved - normal * dot(moved, normal);
    const float way = length(sliding);
    if (way > 0) p = p - sliding * min(1, obstacle.friction * depth / way);
  };
  if (p.y < obstacle.thickness) rub({0, 1, 0}, obstacle.thickness - p.y);
  const Vec3 out = p - obstacle.center;
  const float reach = obstacle.radius + obstacle.thickness;
  if (const float d = length(out); d < reach && d > 0) rub(out / d, reach - d);
}

}  // namespace

MassSpringCloth::MassSpringCloth(std::vector<Vec3> positions, int n, float side)
    : n_(n),
      cell_(side / static_cast<float>(n - 1)),
      positions_(std::move(positions)),
      before_(positions_),
      velocities_(positions_.size()) {}

void MassSpringCloth::step(float dt, const Obstacle& obstacle) {
  parallel_for_blocks(positions_.size(), least_rows * static_cast<std::size_t>(n_), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      velocities_[i].y -= gravity * dt;
      before_[i] = positions_[i];
      positions_[i] += velocities_[i] * dt;
    }
  });
  relax_all(dt);
  parallel_for_blocks(positions_.size(), least_rows * static_cast<std::size_t>(n_), [&](std::size_t begin, std::size_t end) {
    const float damping = 1 - 0.8F * dt;  // of the air
    for (std::size_t i = begin; i < end; ++i) {
      collide(positions_[i], before_[i], obstacle);
      velocities_[i] = (positions_[i] - before_[i]) * (damping / dt);
    }
  });
}

void MassSpringCloth::relax_all(float dt) {
  // Inverse stiffness for unit masses: threads hardly stretch, the weave shears and bends more easily.
  relax(0, 2, 5e-5F, dt);
  relax(2, 0, 5e-5F, dt);
  relax(1, 1, 5e-6F, dt);
  relax(1, -1, 5e-6F, dt);
  relax(0, 1, 0, dt);
  relax(1, 0, 0, dt);
}

/// Relaxes the springs from (row, column) to (row + row_step, column + column_step), of every second step the one group, then the
/// other.
void MassSpringCloth::relax(int row_step, int column_step, float compliance, float dt) {
  const float diagonal = std::sqrt(static_cast<float>(row_step * row_step + column_step * column_step));
  const float rest = cell_ * diagonal;
  const float softness = 2 + compliance / (dt * dt);
  const int first_column = std::max(0, -column_step);
  const int end_column = n_ - std::max(0, column_step);
  const auto spring = [&](int row, int column) {
    const std::size_t a = index(row, column);
    const std::size_t b = index(row + row_step, column + column_step);
    const Vec3 apart = positions_[b] - positions_[a];
    const float now = length(apart);
    if (now == 0) return;
    const Vec3 move = apart * ((now - rest) / (now * softness));
    positions_[a] += move;
    positions_[b] = positions_[b] - move;
  };
  if (row_step == 0) {
    // Within rows: columns in pairs of steps.
    parallel_for_blocks(static_cast<std::size_t>(n_), least_rows, [&](std::size_t begin, std::size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
        for (int group = 0; group < 2; ++group) {
          for (int column = 0; column < end_column; ++column) {
            if (column / column_step % 2 == group) spring(row, column);
          }
        }
      }
    });
    return;
  }
  for (int group = 0; group < 2; ++group) {
    const auto rows = static_cast<std::size_t>(n_ - row_step);
    parallel_for_blocks(rows, least_rows, [&](std::size_t begin, std::size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
        if (row / row_step % 2 != group) continue;
        for (int column = first_column; column < end_column; ++column) spring(row, column);
      }
    });
  }
}

}  // namespace raystudy::procedural
