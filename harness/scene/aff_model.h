#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "harness/scene/aff_track.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What AFF files hold: geometry in a hierarchy of scopes that move, the key frames by name, and the time they are shown for.
struct AffModel {
  /// A scope that moves, in its moving parent (none: -1) and the fixed scopes between.
  struct Joint {
    std::string name;
    int parent;
    Affine before;
  };
  /// Triangles of one joint, in its coordinates.
  struct Part {
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> places;  ///< of the triangles in the scene
    std::size_t first = 0;              ///< vertex
  };
  /// A triangle that goes straight from key to key.
  struct Morph {
    int joint;
    std::uint32_t place;
    std::vector<double> times;
    std::vector<std::array<Vec3, 3>> corners;
  };

  std::map<std::string, AffTrack> tracks;
  std::vector<Joint> joints;  ///< parents before their children; one without a track stands still
  std::map<int, Part> parts;  ///< by joint
  std::vector<Morph> morphs;
  std::vector<std::uint32_t> triangle_materials;  ///< one a triangle, in the files' order
  double begin = 0;
  double end = 0;
  std::size_t frame_count = 0;  ///< 0: static

  /// Gives vertices, triangles, their materials and, where anything moves, equally spaced frames to `scene`. Vertices of a joint
  /// that are equal bit for bit become one.
  void fill(Scene& scene);

 private:
  void place(double time, std::vector<Vec3>& out) const;

  std::size_t first_morph_ = 0;  // vertex
};

}  // namespace raystudy
