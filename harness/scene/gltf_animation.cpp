#include "harness/scene/gltf_animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace raystudy {
namespace {

double squared_norm(std::span<const float> v) {
  double sum = 0;
  for (const float k : v) sum += static_cast<double>(k) * static_cast<double>(k);
  return sum;
}

}  // namespace

Affine GltfPose::transform() const {
  if (matrix) return *matrix;
  return affine_of(scale, rotation, translation);
}

GltfPose pose_of(const GltfModel& model, const tinygltf::Node& node) {
  GltfPose pose;
  if (node.matrix.size() == 16) {
    Affine& t = pose.matrix.emplace();
    for (std::size_t c = 0; c < 4; ++c) {
      std::copy_n(node.matrix.begin() + static_cast<std::ptrdiff_t>(4 * c), 3, t.column[c].begin());
    }
  }
  if (node.translation.size() == 3) std::copy_n(node.translation.begin(), 3, pose.translation.begin());
  if (node.rotation.size() == 4) std::copy_n(node.rotation.begin(), 4, pose.rotation.begin());
  if (node.scale.size() == 3) std::copy_n(node.scale.begin(), 3, pose.scale.begin());
  pose.weights = node.weights;
  if (pose.weights.empty() && node.mesh >= 0) pose.weights = model.at(model.file().meshes, node.mesh, "mesh").weights;
  return pose;
}

GltfAnimation::GltfAnimation(const GltfModel& model) {
  if (model.file().animations.empty()) return;
  const tinygltf::Animation& animation = model.file().animations.front();
  for (std::size_t c = 0; c < animation.channels.size(); ++c) channels_.push_back(read_channel(model, animation, c));
}

GltfAnimation::Channel GltfAnimation::read_channel(const GltfModel& model, const tinygltf::Animation& animation,
                                                   std::size_t index) {
  static const std::vector<std::string> paths{"translation", "rotation", "scale", "weights"};
  static const std::vector<std::string> interpolations{"STEP", "LINEAR", "CUBICSPLINE"};
  const tinygltf::AnimationChannel& channel = animation.channels[index];
  const tinygltf::AnimationSampler& sampler = model.at(animation.samplers, channel.sampler, "animation sampler");
  const tinygltf::Node& node = model.node(channel.target_node);
  const auto one_of = [&](const std::string& found, const std::vector<std::string>& known, std::string_view what) {
    const auto place = std::find(known.begin(), known.end(), found);
    if (place == known.end()) {
      model.fail(fmt::format("channel {} of the animation has the {} '{}'", index, what, found),
                 fmt::format("one of {}", fmt::join(known, ", ")), nearest_name(found, known));
    }
    return static_cast<std::uint8_t>(place - known.begin());
  };
  Channel made;
  made.node = static_cast<std::size_t>(channel.target_node);
  made.path = static_cast<Path>(one_of(channel.target_path, paths, "path"));
  made.interpolation = static_cast<Interpolation>(one_of(sampler.interpolation, interpolations, "interpolation"));
  made.times = model.numbers(sampler.input, TINYGLTF_TYPE_SCALAR);
  made.width = made.path == Path::rotation ? 4 : 3;
  if (made.path == Path::weights) {
    const tinygltf::Mesh& mesh = model.at(model.file().meshes, node.mesh, "mesh");
    made.width = mesh.primitives.empty() ? 0 : mesh.primitives.front().targets.size();
    made.values = model.numbers(sampler.output, TINYGLTF_TYPE_SCALAR);
  } else {
    if (node.matrix.size() == 16) {
      model.fail(fmt::format("node {} has a matrix and is animated", channel.target_node), "translation, rotation and scale");
    }
    made.values = model.numbers(sampler.output, made.path == Path::rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3);
  }
  check_keys(model, made, index, sampler.interpolation);
  return made;
}

void GltfAnimation::check_keys(const GltfModel& model, const Channel& channel, std::size_t index,
                               std::string_view interpolation) {
  if (channel.times.empty()) model.fail(fmt::format("channel {} of the animation has no keys", index), "one at least");
  for (std::size_t k = 0; k < channel.times.size(); ++k) {
    const bool increases = std::isfinite(channel.times[k]) && (k == 0 || channel.times[k] > channel.times[k - 1]);
    if (!increases) {
      model.fail(fmt::format("key {} of channel {} of the animation is at {} s", k, index, channel.times[k]), "increasing times");
    }
  }
  const std::size_t wanted =
      channel.times.size() * channel.width * (channel.interpolation == Interpolation::cubic_spline ? 3 : 1);
  if (channel.values.size() != wanted) {
    model.fail(fmt::format("channel {} of the animation has {} numbers", index, channel.values.size()),
               fmt::format("{}: {} keys of {} by {}", wanted, channel.times.size(), channel.width, interpolation));
  }
  for (std::size_t i = 0; i < wanted; ++i) {
    if (std::isfinite(channel.values[i])) continue;
    model.fail(
        fmt::format("key {} of channel {} of the animation is {}", i * channel.times.size() / wanted, index, channel.values[i]),
        "finite numbers");
  }
  for (std::size_t k = 0; k < channel.times.size() && channel.path == Path::rotation; ++k) {
    if (const double norm = squared_norm(key_value(channel, k, 1)); !(norm > 0)) {
      model.fail(fmt::format("key {} of channel {} of the animation is no rotation", k, index), "a quaternion of length 1");
    }
  }
}

std::vector<double> GltfAnimation::frame_times() const {
  constexpr double least_steps = 24;
  constexpr double most_steps = 300;
  std::vector<double> keys;
  for (const Channel& channel : channels_) keys.insert(keys.end(), channel.times.begin(), channel.times.end());
  std::sort(keys.begin(), keys.end());
  if (keys.empty() || keys.front() == keys.back()) return {};
  const double length = keys.back() - keys.front();
  double gap = length;  // keys that differ by rounding only are one
  for (std::size_t k = 1; k < keys.size(); ++k) {
    if (const double here = keys[k] - keys[k - 1]; here > 1e-4 * length) gap = std::min(gap, here);
  }
  double steps = std::min(std::round(length / gap), most_steps);
  steps *= std::ceil(least_steps / steps);
  std::vector<double> times;
  for (int i = 0; i <= static_cast<int>(steps); ++i) {
    double time = keys.front() + length * i / steps;
    // A key's time is meant to be met although neither is exact.
    const auto near = std::lower_bound(keys.begin(), keys.end(), time - 1e-3 * length / steps);
    if (near != keys.end() && *near - time < 1e-3 * length / steps) time = *near;
    times.push_back(time);
  }
  return times;
}

std::span<const float> GltfAnimation::key_value(const Channel& channel, std::size_t key, std::size_t part) {
  const std::size_t place = channel.interpolation == Interpolation::cubic_spline ? 3 * key + part : key;
  return std::span(channel.values).subspan(place * channel.width, channel.width);
}

std::vector<double> GltfAnimation::value_at(const Channel& channel, double time) {
  const auto after =
      static_cast<std::size_t>(std::upper_bound(channel.times.begin(), channel.times.end(), time) - channel.times.begin());
  const std::size_t before = after == 0 ? 0 : after - 1;
  const std::span<const float> a = key_value(channel, before, 1);
  std::vector<double> value(a.begin(), a.end());
  if (after == 0 || after == channel.times.size() || channel.interpolation == Interpolation::step) return value;
  const std::span<const float> b = key_value(channel, after, 1);
  const double length = static_cast<double>(channel.times[after]) - static_cast<double>(channel.times[before]);
  const double t = (time - static_cast<double>(channel.times[before])) / length;
  if (channel.interpolation == Interpolation::cubic_spline) {
    const std::span<const float> leaving = key_value(channel, before, 2);
    const std::span<const float> arriving = key_value(channel, after, 0);
    for (std::size_t k = 0; k < channel.width; ++k) {
      value[k] = (2 * t * t * t - 3 * t * t + 1) * a[k] + length * (t * t * t - 2 * t * t + t) * leaving[k] +
                 (3 * t * t - 2 * t * t * t) * b[k] + length * (t * t * t - t * t) * arriving[k];
    }
    return value;
  }
  double of_a = 1 - t;
  double of_b = t;
  if (channel.path == Path::rotation) {
    // Along the great circle, the shorter way round.
    double cosine = 0;
    for (std::size_t k = 0; k < 4; ++k) cosine += static_cast<double>(a[k]) * b[k];
    cosine /= std::sqrt(squared_norm(a) * squared_norm(b));
    const double angle = std::acos(std::min(1.0, std::fabs(cosine)));
    if (angle > 1e-6) {
      of_a = std::sin((1 - t) * angle) / std::sin(angle);
      of_b = std::sin(t * angle) / std::sin(angle);
    }
    if (cosine < 0) of_b = -of_b;
  }
  for (std::size_t k = 0; k < channel.width; ++k) value[k] = of_a * a[k] + of_b * b[k];
  return value;
}

void GltfAnimation::apply(double time, std::vector<GltfPose>& poses) const {
  for (const Channel& channel : channels_) {
    GltfPose& pose = poses[channel.node];
    std::vector<double> value = value_at(channel, time);
    switch (channel.path) {
      case Path::translation: std::copy(value.begin(), value.end(), pose.translation.begin()); break;
      case Path::scale: std::copy(value.begin(), value.end(), pose.scale.begin()); break;
      case Path::weights: pose.weights = std::move(value); break;
      case Path::rotation: {
        double norm = 0;
        for (const double k : value) norm += k * k;
        for (std::size_t k = 0; k < 4; ++k) pose.rotation[k] = value[k] / std::sqrt(norm);
        break;
      }
    }
  }
}

}  // namespace raystudy
