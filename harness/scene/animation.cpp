#include "harness/scene/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/error.h"
#include "harness/base/parallel.h"

namespace raystudy {
namespace {

void require_time(const Scene& scene, double time) {
  if (time >= 0 && time <= 1) return;  // false for NaN too
  throw Error(
      Diagnostic{{}, fmt::format("scene '{}': the time is {}", scene.name, time), "a time from 0 (first frame) to 1 (last)", {}});
}

Box box_of(const Scene& scene) {
  Box box;
  for (const Triangle& triangle : scene.triangles) {
    for (int i = 0; i < 3; ++i) box.extend(scene.vertices[triangle[i]]);
  }
  return box;
}

}  // namespace

std::vector<double> uniform_times(std::size_t n) {
  if (n == 0) throw Error("an animation is sampled at 0 frames; expected 1 at least");
  std::vector<double> times(n, 0);
  for (std::size_t i = 1; i < n; ++i) times[i] = static_cast<double>(i) / static_cast<double>(n - 1);
  return times;
}

KeyPosition key_position(const Scene& scene, double time) {
  require_time(scene, time);
  if (scene.frames.empty()) return {};
  const double at = time * static_cast<double>(scene.frames.size() - 1);
  // Times of key frames are met in spite of the rounding of i / (n - 1).
  const double nearest = std::round(at);
  if (std::abs(at - nearest) < 1e-9) return {static_cast<std::size_t>(nearest), 0};
  const auto key = static_cast<std::size_t>(at);
  return {key, static_cast<float>(at - static_cast<double>(key))};
}

SharedArray<Vec3> positions_at(const Scene& scene, double time) {
  const KeyPosition at = key_position(scene, time);
  if (scene.frames.empty()) return scene.vertices;
  if (at.share == 0) return scene.frames[at.key];
  const SharedArray<Vec3>& before = scene.frames[at.key];
  const SharedArray<Vec3>& after = scene.frames[at.key + 1];
  std::vector<Vec3> positions(before.size());
  // A vertex at rest stays where it is, exactly.
  parallel_for_indices(positions.size(), [&](std::size_t v) { positions[v] = before[v] + (after[v] - before[v]) * at.share; });
  return SharedArray<Vec3>(std::move(positions));
}

Scene scene_at(const Scene& scene, double time) {
  Scene frame = scene;
  frame.vertices = positions_at(scene, time);
  frame.frames.clear();
  frame.bounds = box_of(frame);
  if (!scene.frames.empty()) frame.hash = fmt::format("{}@{}", scene.hash, time);
  return frame;
}

std::vector<SharedArray<Vec3>> resampled_frames(const Scene& scene, std::size_t n) {
  std::vector<SharedArray<Vec3>> frames;
  for (const double time : uniform_times(n)) {
    frames.push_back(positions_at(scene, time));
    if (scene.frames.size() < 2) break;
  }
  return frames;
}

Scene part_of(const Scene& scene, double from, double to) {
  require_time(scene, from);
  require_time(scene, to);
  if (!(from < to)) {
    throw Error(Diagnostic{{}, fmt::format("scene '{}': a part from time {} to {}", scene.name, from, to), "a later end", {}});
  }
  Scene part = scene_at(scene, from);
  if (scene.frames.empty()) return part;
  const double steps = std::round((to - from) * static_cast<double>(scene.frames.size() - 1));
  for (const double t : uniform_times(std::max<std::size_t>(2, static_cast<std::size_t>(steps) + 1))) {
    part.frames.push_back(positions_at(scene, std::min(to, from + t * (to - from))));
  }
  part.hash = fmt::format("{}@{}-{}", scene.hash, from, to);
  return part;
}

}  // namespace raystudy
