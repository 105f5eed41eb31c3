#pragma once

#include <cstddef>
#include <vector>

#include "harness/base/shared_array.h"
#include "harness/geometry/vec3.h"
#include "harness/scene/scene.h"

namespace raystudy {

// Time in an animation runs from 0, its first key frame, to 1, its last. Key frames are equally far apart; between two of them
// every vertex moves in a straight line. A static scene has one key frame, its vertices, at every time.

/// n equally spaced times from 0 to 1, both included; for n = 1 time 0. Throws Error for n = 0.
[[nodiscard]] std::vector<double> uniform_times(std::size_t n);

/// Where a time is: `share` of the way from a key frame to the next one; on the key frame itself where `share` is 0.
struct KeyPosition {
  std::size_t key = 0;
  float share = 0;
};

/// Throws Error for a time outside [0, 1].
[[nodiscard]] KeyPosition key_position(const Scene& scene, double time);

/// Positions of all vertices at `time`. At a key frame's time they are its array itself. Throws Error for a time outside [0, 1].
[[nodiscard]] SharedArray<Vec3> positions_at(const Scene& scene, double time);

/// The static scene of one moment: vertices and bounds are those of `time`, everything else is shared with `scene`. Its hash is
/// the animation's with the time. Throws Error for a time outside [0, 1].
[[nodiscard]] Scene scene_at(const Scene& scene, double time);

/// The positions at uniform_times(n): the representative frames (Bittner and Meister 2015, Section 4). A static scene gives its
/// vertices once, whatever n. Throws Error for n = 0.
[[nodiscard]] std::vector<SharedArray<Vec3>> resampled_frames(const Scene& scene, std::size_t n);

/// The animation between two times as one of its own, with key frames as dense as the whole one's, two at least. Its vertices and
/// bounds are those of time `from`. Throws Error unless 0 <= from < to <= 1.
[[nodiscard]] Scene part_of(const Scene& scene, double from, double to);

}  // namespace raystudy
