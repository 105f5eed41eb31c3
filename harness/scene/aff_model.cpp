#include "harness/scene/aff_model.h"

#include <algorithm>
#include <utility>

#include "harness/base/parallel.h"
#include "harness/scene/gather.h"

namespace raystudy {

void AffModel::fill(Scene& scene) {
  std::size_t vertices = 0;
  std::vector<Triangle> triangles(triangle_materials.size());
  for (auto& [joint, part] : parts) {
    weld_equal(part.positions, part.triangles);
    part.first = vertices;
    const auto base = static_cast<std::uint32_t>(vertices);
    for (std::size_t t = 0; t < part.triangles.size(); ++t) {
      const Triangle& from = part.triangles[t];
      triangles[part.places[t]] = {{base + from[0], base + from[1], base + from[2]}};
    }
    vertices += part.positions.size();
  }
  first_morph_ = vertices;
  for (const Morph& morph : morphs) {
    const auto base = static_cast<std::uint32_t>(vertices);
    triangles[morph.place] = {{base, base + 1, base + 2}};
    vertices += 3;
  }
  scene.triangles = SharedArray<Triangle>(std::move(triangles));
  scene.triangle_materials = SharedArray<std::uint32_t>(std::move(triangle_materials));
  std::vector<std::vector<Vec3>> frames(std::max<std::size_t>(frame_count, 1), std::vector<Vec3>(vertices));
  parallel_for_each(frames.size(), [&](std::size_t f) {
    place(frame_count == 0 ? 0 : begin + (end - begin) * static_cast<double>(f) / static_cast<double>(frame_count - 1),
          frames[f]);
  });
  const bool moves = std::any_of(frames.begin(), frames.end(), [&](const auto& frame) { return frame != frames[0]; });
  if (moves) {
    for (auto& frame : frames) scene.frames.emplace_back(std::move(frame));
    scene.vertices = scene.frames[0];
  } else {
    scene.vertices = SharedArray<Vec3>(std::move(frames[0]));
  }
}

void AffModel::place(double time, std::vector<Vec3>& out) const {
  std::vector<Affine> transforms;  // parents come before their children
  for (const Joint& joint : joints) {
    const Affine around = joint.parent < 0 ? joint.before : transforms[static_cast<std::size_t>(joint.parent)] * joint.before;
    const auto track = tracks.find(joint.name);
    transforms.push_back(track == tracks.end() ? around : around * track->second.at(time));
  }
  const auto transform_of = [&](int joint) { return joint < 0 ? Affine{} : transforms[static_cast<std::size_t>(joint)]; };
  for (const auto& [joint, part] : parts) {
    const Affine transform = transform_of(joint);
    for (std::size_t v = 0; v < part.positions.size(); ++v) out[part.first + v] = transform.point(part.positions[v]);
  }
  std::size_t v = first_morph_;
  for (const Morph& morph : morphs) {
    const auto after =
        static_cast<std::size_t>(std::upper_bound(morph.times.begin(), morph.times.end(), time) - morph.times.begin());
    const std::size_t b = std::min(after, morph.times.size() - 1);
    const std::size_t a = after == 0 ? 0 : after - 1;
    const auto u = static_cast<float>(a == b ? 0 : (time - morph.times[a]) / (morph.times[b] - morph.times[a]));
    const Affine transform = transform_of(morph.joint);
    for (std::size_t i = 0; i < 3; ++i) out[v++] = transform.point(morph.corners[a][i] * (1 - u) + morph.corners[b][i] * u);
  }
}

}  // namespace raystudy
