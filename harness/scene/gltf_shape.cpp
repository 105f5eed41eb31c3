#include "harness/scene/gltf_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace raystudy {
namespace {

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

}  // namespace

GltfShape::GltfShape(const GltfModel& model, int node, const tinygltf::Primitive& primitive)
    : node_(static_cast<std::size_t>(node)), rest_(model.vectors(attribute(primitive, "POSITION"))) {
  read_targets(model, primitive);
  const int skin = model.node(node).skin;
  if (skin >= 0) read_skin(model, model.at(model.file().skins, skin, "skin"), primitive);
}

void GltfShape::read_targets(const GltfModel& model, const tinygltf::Primitive& primitive) {
  for (const auto& target : primitive.targets) {
    const auto position = target.find("POSITION");
    // A target may move normals alone.
    targets_.push_back(position == target.end() ? std::vector<Vec3>(rest_.size()) : model.vectors(position->second));
    if (targets_.back().size() != rest_.size()) {
      model.fail(fmt::format("a morph target has {} vertices", targets_.back().size()),
                 fmt::format("{}, as the mesh it displaces", rest_.size()));
    }
  }
}

void GltfShape::read_skin(const GltfModel& model, const tinygltf::Skin& skin, const tinygltf::Primitive& primitive) {
  joints_ = skin.joints;
  for (const int joint : joints_) (void)model.node(joint);
  inverse_bind_.resize(joints_.size());
  if (skin.inverseBindMatrices >= 0) {
    const std::vector<float> numbers = model.numbers(skin.inverseBindMatrices, TINYGLTF_TYPE_MAT4);
    if (numbers.size() < 16 * joints_.size()) {
      model.fail(fmt::format("a skin of {} joints has {} inverse bind matrices", joints_.size(), numbers.size() / 16),
                 "one a joint");
    }
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t k = 0; k < 3; ++k) inverse_bind_[j].column[c][k] = static_cast<double>(numbers[16 * j + 4 * c + k]);
      }
    }
  }
  read_influences(model, primitive);
}

void GltfShape::read_influences(const GltfModel& model, const tinygltf::Primitive& primitive) {
  std::vector<std::vector<std::uint32_t>> joints;  // by set of four
  std::vector<std::vector<float>> weights;
  for (int set = 0; attribute(primitive, fmt::format("JOINTS_{}", set)) >= 0; ++set) {
    joints.push_back(model.integers(attribute(primitive, fmt::format("JOINTS_{}", set)), TINYGLTF_TYPE_VEC4));
    weights.push_back(model.numbers(attribute(primitive, fmt::format("WEIGHTS_{}", set)), TINYGLTF_TYPE_VEC4));
    if (joints.back().size() != 4 * rest_.size() || weights.back().size() != 4 * rest_.size()) {
      model.fail(fmt::format("{} joints and {} weights of set {}", joints.back().size(), weights.back().size(), set),
                 fmt::format("four of each for {} vertices", rest_.size()));
    }
  }
  if (joints.empty()) model.fail("a mesh with a skin has no JOINTS_0", "joints and weights of every vertex");
  for (std::size_t v = 0; v < rest_.size(); ++v) {
    const std::size_t first = influences_.size();
    float sum = 0;
    for (std::size_t set = 0; set < joints.size(); ++set) {
      for (std::size_t k = 4 * v; k < 4 * v + 4; ++k) {
        const float weight = weights[set][k];
        if (weight != 0 && joints[set][k] >= joints_.size()) {
          model.fail(fmt::format("vertex {} follows joint {} of its skin", v, joints[set][k]),
                     fmt::format("an index below {}", joints_.size()));
        }
        influences_.push_back({weight == 0 ? 0 : joints[set][k], weight});
        sum += weight;
      }
    }
    if (!(sum > 0)) model.fail(fmt::format("the weights of vertex {} sum to {}", v, sum), "1");
    // Quantized weights sum to about one.
    for (std::size_t i = first; i < influences_.size(); ++i) influences_[i].weight /= sum;
  }
}

void GltfShape::place(std::span<const double> weights, std::span<const Affine> transforms, std::span<Vec3> out) const {
  if (rest_.empty()) return;
  std::copy(rest_.begin(), rest_.end(), out.begin());
  for (std::size_t t = 0; t < std::min(weights.size(), targets_.size()); ++t) {
    const auto weight = static_cast<float>(weights[t]);
    for (std::size_t v = 0; v < out.size() && weight != 0; ++v) out[v] += targets_[t][v] * weight;
  }
  if (joints_.empty()) {
    for (Vec3& v : out) v = transforms[node_].point(v);
    return;
  }
  std::vector<Affine> moves;
  moves.reserve(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    moves.push_back(transforms[static_cast<std::size_t>(joints_[j])] * inverse_bind_[j]);
  }
  const std::size_t each = influences_.size() / rest_.size();
  for (std::size_t v = 0; v < out.size(); ++v) {
    Vec3 sum;
    for (const Influence& i : std::span(influences_).subspan(v * each, each)) {
      if (i.weight != 0) sum += moves[i.joint].point(out[v]) * i.weight;
    }
    out[v] = sum;
  }
}

}  // namespace raystudy
