#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/trees.h"

namespace raystudy::test {

/// `frames` key frames of small boxes, each on a straight way of its own from one random place to another.
inline Scene crossing_boxes(std::size_t count, std::size_t frames, std::uint64_t seed) {
  const std::vector<Box> from = random_boxes(count, seed);
  const std::vector<Box> to = random_boxes(count, seed + 1);
  Scene scene = scene_of(from);
  for (std::size_t f = 0; f < frames; ++f) {
    const float share = frames < 2 ? 0 : static_cast<float>(f) / static_cast<float>(frames - 1);
    std::vector<Vec3> positions(scene.vertices.begin(), scene.vertices.end());
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] += (to[v / 3].lower - from[v / 3].lower) * share;
    scene.frames.emplace_back(std::move(positions));
  }
  scene.vertices = scene.frames.front();
  finish_scene(scene, "crossing boxes");
  return scene;
}

}  // namespace raystudy::test
