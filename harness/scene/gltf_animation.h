#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "harness/scene/affine.h"
#include "harness/scene/gltf_model.h"

namespace raystudy {

/// How a node stands in its parent, and the weights of its mesh's morph targets.
struct GltfPose {
  std::array<double, 3> translation{};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w
  std::array<double, 3> scale{1, 1, 1};
  std::optional<Affine> matrix;  ///< in place of the three above
  std::vector<double> weights;   ///< none: all zero

  [[nodiscard]] Affine transform() const;
};
/// As the file has it without any animation.
[[nodiscard]] GltfPose pose_of(const GltfModel& model, const tinygltf::Node& node);

/// The file's first animation: translation, rotation, scale and morph weights of nodes over time, by STEP, LINEAR and CUBICSPLINE
/// (glTF 2.0, appendix C). Other animations of a file are other clips of the same things; they are left out.
class GltfAnimation {
 public:
  /// Throws Error where a channel or sampler is malformed.
  explicit GltfAnimation(const GltfModel& model);

  /// Equally spaced times from the first key to the last, in seconds; empty without an animation. They are a multiple of the
  /// smallest distance of two keys, where the keys are equally spaced all of them, and 25 to 301 in number.
  [[nodiscard]] std::vector<double> frame_times() const;

  /// Changes the poses of the animated nodes (indexed as the file's nodes) to those of `time`.
  void apply(double time, std::vector<GltfPose>& poses) const;

 private:
  enum class Path : std::uint8_t { translation, rotation, scale, weights };
  enum class Interpolation : std::uint8_t { step, linear, cubic_spline };
  struct Channel {
    std::size_t node = 0;
    Path path = Path::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;   ///< increasing
    std::vector<float> values;  ///< `width` a key; of a cubic spline three times as many: in-tangent, value, out-tangent
    std::size_t width = 3;
  };

  [[nodiscard]] static Channel read_channel(const GltfModel& model, const tinygltf::Animation& animation, std::size_t index);
  static void check_keys(const GltfModel& model, const Channel& channel, std::size_t index, std::string_view interpolation);
  /// Of a cubic spline the in-tangent, value or out-tangent (part 0, 1, 2); else the value.
  [[nodiscard]] static std::span<const float> key_value(const Channel& channel, std::size_t key, std::size_t part);
  [[nodiscard]] static std::vector<double> value_at(const Channel& channel, double time);

  std::vector<Channel> channels_;
};

}  // namespace raystudy
