#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "harness/base/parallel.h"
#include "harness/scene/scene.h"

namespace raystudy::procedural {

/// Vertex positions by key frame, in the making.
using KeyFrames = std::vector<std::vector<Vec3>>;

/// `count` frames that all stand at `vertices`: what does not move needs nothing more.
inline KeyFrames still_frames(std::span<const Vec3> vertices, int count) {
  KeyFrames frames(static_cast<std::size_t>(count));
  parallel_for_indices(frames.size(), [&](std::size_t f) { frames[f].assign(vertices.begin(), vertices.end()); });
  return frames;
}

/// Gives the frames to `scene`, whose vertices become those of the first.
inline void set_frames(Scene& scene, KeyFrames frames) {
  for (auto& frame : frames) scene.frames.emplace_back(std::move(frame));
  scene.vertices = scene.frames.front();
}

}  // namespace raystudy::procedural
