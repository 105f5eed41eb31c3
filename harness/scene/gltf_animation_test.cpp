#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "harness/scene/read.h"
#include "harness/scene/test_files.h"

namespace raystudy {
namespace {

/// A small model with a triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) as mesh 0, put together piece by piece.
class Model {
 public:
  Model() { (void)floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}); }

  /// Adds an accessor and returns its index.
  int floats(const std::string& type, const std::vector<float>& values) {
    std::string bytes;
    for (const float v : values) bytes += test::packed(v);
    return accessor(type, 5126, values.size(), bytes);
  }
  int bytes(const std::string& type, const std::vector<std::uint8_t>& values) {
    return accessor(type, 5121, values.size(), std::string(values.begin(), values.end()));
  }
  int view(const std::string& bytes) {
    views_ += fmt::format(R"({}{{"buffer": 0, "byteOffset": {}, "byteLength": {}}})", views_.empty() ? "" : ", ", buffer_.size(),
                          bytes.size());
    buffer_ += bytes + std::string((4 - bytes.size() % 4) % 4, '\0');
    return view_count_++;
  }
  int raw_accessor(const std::string& json) {
    accessors_ += (accessors_.empty() ? "" : ", ") + json;
    return accessor_count_++;
  }
  /// A channel of the animation.
  void channel(int node, const std::string& path, const std::string& interpolation, const std::vector<float>& times,
               const std::vector<float>& values) {
    const int input = floats("SCALAR", times);
    const int output = floats(path == "weights" ? "SCALAR" : path == "rotation" ? "VEC4" : "VEC3", values);
    const std::string separator = samplers_.empty() ? "" : ", ";
    samplers_ +=
        fmt::format(R"({}{{"input": {}, "output": {}, "interpolation": "{}"}})", separator, input, output, interpolation);
    channels_ +=
        fmt::format(R"({}{{"sampler": {}, "target": {{"node": {}, "path": "{}"}}}})", separator, channel_count_++, node, path);
  }

  std::string nodes = R"({"mesh": 0})";
  std::string roots = "0";
  std::string primitive = R"({"attributes": {"POSITION": 0}})";
  std::string mesh_more;  // beside the primitives
  std::string more;       // beside everything

  [[nodiscard]] Scene read() const {
    const test::CleanEnvironment environment;
    return read(environment);
  }
  [[nodiscard]] std::string error() const {
    const test::CleanEnvironment environment;
    const std::string text = test::error_of([&] { (void)read(environment); });
    const std::string file = environment.folder.text() + "/model.gltf: ";
    return text.starts_with(file) ? text.substr(file.size()) : text;
  }

 private:
  [[nodiscard]] Scene read(const test::CleanEnvironment& environment) const {
    environment.folder.write("data.bin", buffer_);
    const std::string animations =
        channels_.empty() ? "" : fmt::format(R"("animations": [{{"samplers": [{}], "channels": [{}]}}], )", samplers_, channels_);
    return read_scene(environment.folder.write(
        "model.gltf", fmt::format(R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [{}]}}], "nodes": [{}],
"meshes": [{{"primitives": [{}]{}}}], {}{}"accessors": [{}], "bufferViews": [{}],
"buffers": [{{"uri": "data.bin", "byteLength": {}}}]}})",
                                  roots, nodes, primitive, mesh_more, animations, more, accessors_, views_, buffer_.size())));
  }
  int accessor(const std::string& type, int component, std::size_t numbers, const std::string& content) {
    const std::size_t each = type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
    return raw_accessor(fmt::format(R"({{"bufferView": {}, "componentType": {}, "count": {}, "type": "{}"}})", view(content),
                                    component, numbers / each, type));
  }

  std::string buffer_;
  std::string views_;
  std::string accessors_;
  std::string samplers_;
  std::string channels_;
  int view_count_ = 0;
  int accessor_count_ = 0;
  int channel_count_ = 0;
};

void expect_at(const Scene& scene, std::size_t frame, std::size_t vertex, Vec3 wanted) {
  ASSERT_LT(frame, scene.frames.size());
  const Vec3 found = scene.frames[frame][vertex];
  EXPECT_NEAR(found.x, wanted.x, 1e-5) << "frame " << frame;
  EXPECT_NEAR(found.y, wanted.y, 1e-5) << "frame " << frame;
  EXPECT_NEAR(found.z, wanted.z, 1e-5) << "frame " << frame;
}

TEST(GltfAnimation, LinearTranslationMeetsTheFilesKeys) {
  Model model;
  model.channel(0, "translation", "LINEAR", {0, 1, 3}, {0, 0, 0, 2, 0, 0, 2, 4, 0});
  const Scene scene = model.read();
  ASSERT_EQ(scene.frames.size(), 25U);  // three steps of one second, each in eight
  EXPECT_TRUE(std::equal(scene.vertices.begin(), scene.vertices.end(), scene.frames[0].begin()));
  expect_at(scene, 0, 1, {1, 0, 0});
  expect_at(scene, 4, 1, {2, 0, 0});
  expect_at(scene, 8, 1, {3, 0, 0});
  expect_at(scene, 16, 1, {3, 2, 0});
  expect_at(scene, 24, 1, {3, 4, 0});
}

TEST(GltfAnimation, StepHoldsUntilTheNextKey) {
  Model model;
  model.channel(0, "translation", "STEP", {0.1F, 0.4F, 0.7F}, {0, 0, 0, 5, 0, 0, 5, 0, 7});
  const Scene scene = model.read();
  ASSERT_EQ(scene.frames.size(), 25U);
  expect_at(scene, 11, 0, {0, 0, 0});
  expect_at(scene, 12, 0, {5, 0, 0});
  expect_at(scene, 23, 0, {5, 0, 0});
  expect_at(scene, 24, 0, {5, 0, 7});
}

TEST(GltfAnimation, CubicSplineByHand) {
  Model model;
  // In-tangent, value, out-tangent of two keys that are 2 s apart. Half way: 0.5·0 + 2·0.125·1 + 0.5·1 - 2·0.125·3 = 0.
  model.channel(0, "translation", "CUBICSPLINE", {1, 3}, {9, 0, 0, 0, 0, 0, 1, 0, 0, 3, 0, 0, 1, 0, 0, 9, 0, 0});
  const Scene scene = model.read();
  ASSERT_EQ(scene.frames.size(), 25U);
  expect_at(scene, 0, 0, {0, 0, 0});
  expect_at(scene, 12, 0, {0, 0, 0});
  // At a quarter: 2·0.140625·1 + 0.15625·1 - 2·0.046875·3 = 0.15625.
  expect_at(scene, 6, 0, {0.15625F, 0, 0});
  expect_at(scene, 24, 0, {1, 0, 0});
}

TEST(GltfAnimation, RotationsGoTheShorterWayAtEvenSpeed) {
  const float half = 0.70710678F;
  for (const float sign : {1.0F, -1.0F}) {
    Model model;
    model.channel(0, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, sign * half, sign * half});
    const Scene scene = model.read();
    expect_at(scene, 12, 1, {half, half, 0});
    expect_at(scene, 8, 1, {0.8660254F, 0.5F, 0});
    expect_at(scene, 24, 1, {0, 1, 0});
  }
}

TEST(GltfAnimation, ChildrenFollowTheirParents) {
  Model model;
  model.nodes = R"({"children": [1], "translation": [0, 0, 1]}, {"mesh": 0, "translation": [3, 0, 0]})";
  model.channel(0, "scale", "LINEAR", {0, 1}, {1, 1, 1, 2, 3, 4});
  const Scene scene = model.read();
  expect_at(scene, 0, 1, {4, 0, 1});
  expect_at(scene, 24, 1, {8, 0, 1});
  expect_at(scene, 24, 2, {6, 3, 1});
}

TEST(GltfAnimation, MorphTargets) {
  Model model;
  const int target = model.floats("VEC3", {0, 0, 2, 0, 0, 0, 0, 0, 0});
  const int other = model.floats("VEC3", {0, 0, 0, 0, 4, 0, 0, 0, 0});
  model.primitive =
      fmt::format(R"({{"attributes": {{"POSITION": 0}}, "targets": [{{"POSITION": {}}}, {{"POSITION": {}}}]}})", target, other);
  model.mesh_more = R"(, "weights": [0.5, 0])";
  const Scene still = model.read();
  EXPECT_TRUE(still.frames.empty());
  EXPECT_EQ(still.vertices[0], (Vec3{0, 0, 1}));
  model.channel(0, "weights", "LINEAR", {0, 1}, {0, 1, 1, 0});
  const Scene scene = model.read();
  expect_at(scene, 0, 0, {0, 0, 0});
  expect_at(scene, 0, 1, {1, 4, 0});
  expect_at(scene, 6, 0, {0, 0, 0.5F});
  expect_at(scene, 6, 1, {1, 3, 0});
  expect_at(scene, 24, 1, {1, 0, 0});
}

TEST(GltfAnimation, SparseTargets) {
  Model model;
  const int places = model.view(std::string("\x02", 1));
  const int values = model.view(test::packed(0.F, 0.F, 8.F));
  const int target = model.raw_accessor(fmt::format(
      R"({{"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {{"count": 1, "indices": {{"bufferView": {}, "componentType": 5121}},
 "values": {{"bufferView": {}}}}}}})",
      places, values));
  model.primitive = fmt::format(R"({{"attributes": {{"POSITION": 0}}, "targets": [{{"POSITION": {}}}]}})", target);
  model.mesh_more = R"(, "weights": [0.25])";
  const Scene scene = model.read();
  EXPECT_EQ(scene.vertices[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(scene.vertices[2], (Vec3{0, 1, 2}));
}

/// Two joints, the second at (1, 0, 0); vertex 0 follows the first, 1 the second, 2 both alike.
Model skinned(std::uint8_t joint = 1) {
  Model model;
  const int joints = model.bytes("VEC4", {0, 0, 0, 0, joint, 0, 0, 0, 0, 1, 0, 0});
  const int weights = model.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0});
  const int inverse =
      model.floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
  model.primitive = fmt::format(R"({{"attributes": {{"POSITION": 0, "JOINTS_0": {}, "WEIGHTS_0": {}}}}})", joints, weights);
  // The node's own place does not count for a mesh with a skin.
  model.nodes = R"({"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, {"children": [2]}, {"translation": [1, 0, 0]})";
  model.roots = "0, 1";
  model.more = fmt::format(R"("skins": [{{"joints": [1, 2], "inverseBindMatrices": {}}}], )", inverse);
  return model;
}

TEST(GltfAnimation, Skins) {
  Model model = skinned();
  EXPECT_EQ(model.read().vertices[1], (Vec3{1, 0, 0}));
  const float half = 0.70710678F;
  model.channel(2, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, half, half});
  model.channel(1, "translation", "LINEAR", {0, 1}, {0, 0, 0, 0, 0, 5});
  const Scene scene = model.read();
  expect_at(scene, 24, 0, {0, 0, 5});
  expect_at(scene, 24, 1, {1, 0, 5});
  // (0, 1, 0) from the second joint is (-1, 1, 0), turned (-1, -1, 0), which is (0, -1, 5): half of it, and half of (0, 1, 5).
  expect_at(scene, 24, 2, {0, 0, 5});
}

TEST(GltfAnimation, FramesAreAsManyAsTheKeysAskFor) {
  const auto frames = [](const std::vector<float>& times) {
    Model model;
    std::vector<float> values;
    for (std::size_t i = 0; i < times.size(); ++i) values.insert(values.end(), {static_cast<float>(i), 0, 0});
    model.channel(0, "translation", "LINEAR", times, values);
    return model.read().frames.size();
  };
  EXPECT_EQ(frames({5}), 0U) << "one key is no motion";
  EXPECT_EQ(frames({0, 2}), 25U);
  EXPECT_EQ(frames({0, 0.5F, 1.5F, 2.5F}), 26U) << "five steps of half a second, each in five";
  std::vector<float> hundred(101);
  for (std::size_t i = 0; i < hundred.size(); ++i) hundred[i] = static_cast<float>(i) / 30;
  EXPECT_EQ(frames(hundred), 101U);
  std::vector<float> thousand(1001);
  for (std::size_t i = 0; i < thousand.size(); ++i) thousand[i] = static_cast<float>(i) / 30;
  EXPECT_EQ(frames(thousand), 301U);
}

TEST(GltfAnimation, CamerasAreThoseOfTheFirstKeyAndDoNotMakeAnAnimation) {
  Model model;
  model.nodes = R"({"mesh": 0}, {"camera": 0, "name": "eye"})";
  model.roots = "0, 1";
  model.more = R"("cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}], )";
  model.channel(1, "translation", "LINEAR", {1, 2}, {0, 0, 3, 0, 0, 9});
  const Scene scene = model.read();
  EXPECT_EQ(scene.camera("eye").eye, (Vec3{0, 0, 3}));
  EXPECT_TRUE(scene.frames.empty());
}

std::string channel_error(const std::string& path, const std::string& interpolation, const std::vector<float>& times,
                          const std::vector<float>& values, const std::string& nodes = R"({"mesh": 0})", int node = 0) {
  Model model;
  model.nodes = nodes;
  model.channel(node, path, interpolation, times, values);
  return model.error();
}

TEST(GltfAnimation, ErrorsOfChannels) {
  EXPECT_EQ(channel_error("translation", "LINEAR", {0, 1, 1}, std::vector<float>(9)),
            "key 2 of channel 0 of the animation is at 1 s; expected increasing times");
  EXPECT_EQ(channel_error("translation", "LINEAR", {0, std::numeric_limits<float>::quiet_NaN()}, std::vector<float>(6)),
            "key 1 of channel 0 of the animation is at nan s; expected increasing times");
  EXPECT_EQ(channel_error("scale", "LINEAR", {0, 1}, std::vector<float>(9)),
            "channel 0 of the animation has 9 numbers; expected 6: 2 keys of 3 by LINEAR");
  EXPECT_EQ(channel_error("rotation", "CUBICSPLINE", {0, 1}, std::vector<float>(8)),
            "channel 0 of the animation has 8 numbers; expected 24: 2 keys of 4 by CUBICSPLINE");
  EXPECT_EQ(channel_error("translation", "LINAER", {0, 1}, std::vector<float>(6)),
            "channel 0 of the animation has the interpolation 'LINAER'; expected one of STEP, LINEAR, CUBICSPLINE; did you mean "
            "'LINEAR'?");
  EXPECT_EQ(channel_error("translate", "LINEAR", {0, 1}, std::vector<float>(6)),
            "channel 0 of the animation has the path 'translate'; expected one of translation, rotation, scale, weights; did you "
            "mean 'translation'?");
  EXPECT_EQ(channel_error("translation", "LINEAR", {0, 1}, std::vector<float>(6), R"({"mesh": 0})", 4),
            "the file refers to node 4; expected an index below 1");
  EXPECT_EQ(channel_error("translation", "LINEAR", {0, 1}, std::vector<float>(6),
                          R"({"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})"),
            "node 0 has a matrix and is animated; expected translation, rotation and scale");
  EXPECT_EQ(channel_error("translation", "LINEAR", {}, {}), "channel 0 of the animation has no keys; expected one at least");
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(channel_error("translation", "LINEAR", {0, 1}, {0, 0, 0, 0, nan, 0}),
            "key 1 of channel 0 of the animation is nan; expected finite numbers");
  EXPECT_EQ(channel_error("scale", "CUBICSPLINE", {0, 1},
                          {1, 1, 1, 1, 1, 1, 1, 1, std::numeric_limits<float>::infinity(), 1, 1, 1, 1, 1, 1, 1, 1, 1}),
            "key 0 of channel 0 of the animation is inf; expected finite numbers");
  EXPECT_EQ(channel_error("rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, nan, 1}),
            "key 1 of channel 0 of the animation is nan; expected finite numbers");
  EXPECT_EQ(channel_error("rotation", "LINEAR", {0, 1}, std::vector<float>(8)),
            "key 0 of channel 0 of the animation is no rotation; expected a quaternion of length 1");
}

TEST(GltfAnimation, ErrorsOfSkinsAndTargets) {
  EXPECT_EQ(skinned(7).error(), "vertex 1 follows joint 7 of its skin; expected an index below 2");
  Model unreached = skinned();
  unreached.roots = "0";
  EXPECT_EQ(unreached.error(), "joint node 1 is not in the scene; expected a node below its roots");
  Model plain;
  plain.nodes = R"({"mesh": 0, "skin": 0}, {})";
  plain.roots = "0, 1";
  plain.more = R"("skins": [{"joints": [1]}], )";
  EXPECT_EQ(plain.error(), "a mesh with a skin has no JOINTS_0; expected joints and weights of every vertex");
  Model short_target;
  const int target = short_target.floats("VEC3", {0, 0, 2});
  short_target.primitive = fmt::format(R"({{"attributes": {{"POSITION": 0}}, "targets": [{{"POSITION": {}}}]}})", target);
  EXPECT_EQ(short_target.error(), "a morph target has 1 vertices; expected 3, as the mesh it displaces");
  Model light = skinned();
  const int joints = light.bytes("VEC4", std::vector<std::uint8_t>(12));
  const int weights = light.floats("VEC4", std::vector<float>(12));
  light.primitive = fmt::format(R"({{"attributes": {{"POSITION": 0, "JOINTS_0": {}, "WEIGHTS_0": {}}}}})", joints, weights);
  EXPECT_EQ(light.error(), "the weights of vertex 0 sum to 0; expected 1");
}

}  // namespace
}  // namespace raystudy
