#pragma once

#include <tiny_gltf.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "harness/base/error.h"
#include "harness/scene/source.h"

namespace raystudy {

/// A glTF file that tinygltf has parsed. It checks little; here every reference and every accessor is checked when it is
/// followed.
class GltfModel {
 public:
  /// Throws Error where the file cannot be parsed or needs an extension that no reader here knows.
  explicit GltfModel(const SourceFile& source);

  /// Throws Error naming the file.
  [[noreturn]] void fail(std::string message, std::string expected = {}, std::string nearest = {}) const;

  [[nodiscard]] const tinygltf::Model& file() const { return model_; }
  template <class T>
  [[nodiscard]] const T& at(const std::vector<T>& list, int index, std::string_view what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= list.size()) {
      fail("the file refers to " + std::string(what) + " " + std::to_string(index),
           "an index below " + std::to_string(list.size()));
    }
    return list[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const tinygltf::Node& node(int index) const { return at(model_.nodes, index, "node"); }

  /// An accessor's numbers, element after element; integer ones as `normalized` says (KHR_mesh_quantization), sparse ones filled.
  [[nodiscard]] std::vector<float> numbers(int accessor, int type) const;
  [[nodiscard]] std::vector<Vec3> vectors(int accessor) const;
  /// An accessor's unsigned integers, element after element.
  [[nodiscard]] std::vector<std::uint32_t> integers(int accessor, int type) const;

 private:
  /// Where elements of `bytes` each lie.
  struct View {
    const unsigned char* data;
    std::size_t stride;
  };

  [[nodiscard]] const tinygltf::Accessor& accessor_of(int index, int type) const;
  [[nodiscard]] View view(int accessor, int buffer_view, std::size_t offset, std::size_t count, std::size_t element) const;
  [[nodiscard]] float number(const tinygltf::Accessor& a, const unsigned char* p) const;
  [[nodiscard]] std::uint32_t integer(int component_type, const unsigned char* p) const;
  void fill_sparse(int index, const tinygltf::Accessor& a, std::vector<float>& numbers) const;

  std::string name_;
  tinygltf::Model model_;
};

}  // namespace raystudy
