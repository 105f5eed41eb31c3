#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "harness/scene/gltf_animation.h"

namespace raystudy {

/// The vertices of a primitive as one node shows them: at rest, displaced by morph targets, and placed by the node or, where it
/// has a skin, by the skin's joints (glTF 2.0, sections 3.7.2.2 and 3.7.3).
class GltfShape {
 public:
  /// Throws Error where targets, joints or weights do not fit.
  GltfShape(const GltfModel& model, int node, const tinygltf::Primitive& primitive);

  [[nodiscard]] std::size_t size() const { return rest_.size(); }
  /// Indices of the nodes that move it, besides its own.
  [[nodiscard]] std::span<const int> joints() const { return joints_; }

  /// Positions for the morph weights of its node and the global transforms of all nodes.
  void place(std::span<const double> weights, std::span<const Affine> transforms, std::span<Vec3> out) const;

 private:
  void read_targets(const GltfModel& model, const tinygltf::Primitive& primitive);
  void read_skin(const GltfModel& model, const tinygltf::Skin& skin, const tinygltf::Primitive& primitive);
  void read_influences(const GltfModel& model, const tinygltf::Primitive& primitive);

  struct Influence {
    std::uint32_t joint;
    float weight;
  };

  std::size_t node_;
  std::vector<Vec3> rest_;
  std::vector<std::vector<Vec3>> targets_;  ///< displacements
  std::vector<int> joints_;                 ///< nodes
  std::vector<Affine> inverse_bind_;        ///< one a joint
  std::vector<Influence> influences_;       ///< as many for every vertex
};

}  // namespace raystudy
