#include "harness/scene/gltf_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace raystudy {
namespace {

/// The file callbacks tinygltf wants, over SourceFile::sibling.
tinygltf::FsCallbacks callbacks(const SourceFile& source) {
  tinygltf::FsCallbacks fs{};
  fs.FileExists = [](const std::string& file, void* data) {
    return static_cast<const SourceFile*>(data)->sibling(file).has_value();
  };
  fs.ExpandFilePath = [](const std::string& file, void* /*data*/) { return file; };
  fs.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& file, void* data) {
    const auto bytes = static_cast<const SourceFile*>(data)->sibling(file);
    if (!bytes) {
      *error += "there is no " + file;
      return false;
    }
    out->assign(bytes->begin(), bytes->end());
    return true;
  };
  fs.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; };
  fs.user_data = const_cast<SourceFile*>(&source);  // NOLINT: the interface is C's; nothing is changed
  return fs;
}

template <class T>
T load(const unsigned char* p) {
  T value;
  std::memcpy(&value, p, sizeof value);
  return value;
}

std::string_view type_name(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR: return "SCALAR";
    case TINYGLTF_TYPE_VEC3: return "VEC3";
    case TINYGLTF_TYPE_VEC4: return "VEC4";
    default: return "MAT4";
  }
}

std::size_t components_of(int type) {
  return static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type)));
}

std::size_t component_bytes(int component_type) {
  return static_cast<std::size_t>(std::max(0, tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type))));
}

}  // namespace

GltfModel::GltfModel(const SourceFile& source) : name_(source.name) {
  tinygltf::TinyGLTF loader;
  // Images are not needed, and decoding them would only be another way to fail.
  loader.SetImageLoader(
      [](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) { return true; },
      nullptr);
  loader.SetFsCallbacks(callbacks(source));
  std::string error;
  std::string warning;
  const auto size = static_cast<unsigned>(source.bytes.size());
  bool good = false;
  try {
    good = as_text(source.bytes).starts_with("glTF")
               ? loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                             reinterpret_cast<const unsigned char*>(source.bytes.data()), size)
               : loader.LoadASCIIFromString(&model_, &error, &warning, source.bytes.data(), size, "");
  } catch (const std::exception& thrown) {
    error = thrown.what();
  }
  if (!good) {
    while (error.ends_with('\n')) error.pop_back();
    std::replace(error.begin(), error.end(), '\n', ' ');
    fail(fmt::format("tinygltf cannot read the file: {}", error));
  }
  for (const std::string& extension : model_.extensionsRequired) {
    if (extension == "KHR_draco_mesh_compression" || extension == "EXT_meshopt_compression") {
      fail(fmt::format("the file needs the extension {}", extension), "uncompressed meshes");
    }
  }
}

void GltfModel::fail(std::string message, std::string expected, std::string nearest) const {
  throw Error(Diagnostic{{name_, 0, 0}, std::move(message), std::move(expected), std::move(nearest)});
}

const tinygltf::Accessor& GltfModel::accessor_of(int index, int type) const {
  const tinygltf::Accessor& a = at(model_.accessors, index, "accessor");
  if (a.type != type) fail(fmt::format("accessor {} has the wrong type", index), std::string(type_name(type)));
  if (component_bytes(a.componentType) == 0) {
    fail(fmt::format("accessor {} has component type {}", index, a.componentType), "5120 to 5126");
  }
  return a;
}

GltfModel::View GltfModel::view(int accessor, int buffer_view, std::size_t offset, std::size_t count, std::size_t element) const {
  const tinygltf::BufferView& v = at(model_.bufferViews, buffer_view, "buffer view");
  const tinygltf::Buffer& b = at(model_.buffers, v.buffer, "buffer");
  const std::size_t stride = v.byteStride == 0 ? element : v.byteStride;
  const std::size_t size = b.data.size();
  const bool fits = v.byteOffset <= size && v.byteLength <= size - v.byteOffset && offset <= v.byteLength &&
                    (count == 0 || (element <= v.byteLength - offset && count - 1 <= (v.byteLength - offset - element) / stride));
  if (!fits) {
    fail(fmt::format("accessor {} with {} elements reaches past its buffer of {} bytes", accessor, count, size),
         "a complete file");
  }
  return {b.data.data() + v.byteOffset + offset, stride};
}

float GltfModel::number(const tinygltf::Accessor& a, const unsigned char* p) const {
  const auto scaled = [&a](float value, float most) { return a.normalized ? std::max(value / most, -1.0F) : value; };
  switch (a.componentType) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return load<float>(p);
    case TINYGLTF_COMPONENT_TYPE_BYTE: return scaled(load<std::int8_t>(p), 127);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return scaled(load<std::uint8_t>(p), 255);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return scaled(load<std::int16_t>(p), 32767);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return scaled(load<std::uint16_t>(p), 65535);
    default: fail(fmt::format("numbers have component type {}", a.componentType), "float, or 8 or 16 bit integers");
  }
}

std::uint32_t GltfModel::integer(int component_type, const unsigned char* p) const {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return load<std::uint8_t>(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return load<std::uint16_t>(p);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return load<std::uint32_t>(p);
    default: fail(fmt::format("indices have component type {}", component_type), "unsigned integers");
  }
}

std::vector<float> GltfModel::numbers(int accessor, int type) const {
  const tinygltf::Accessor& a = accessor_of(accessor, type);
  const std::size_t components = components_of(type);
  const std::size_t bytes = component_bytes(a.componentType);
  std::vector<float> numbers;
  if (a.sparse.isSparse && a.bufferView < 0) {
    // All zero but for what the sparse part says: no buffer bounds the count.
    constexpr std::size_t most = std::size_t{1} << 24U;
    if (a.count > most) {
      fail(fmt::format("sparse accessor {} has {} elements", accessor, a.count), fmt::format("at most {}", most));
    }
    numbers.resize(a.count * components);
  } else {
    const View v = view(accessor, a.bufferView, a.byteOffset, a.count, bytes * components);
    numbers.reserve(a.count * components);
    for (std::size_t i = 0; i < a.count; ++i) {
      for (std::size_t k = 0; k < components; ++k) numbers.push_back(number(a, v.data + i * v.stride + k * bytes));
    }
  }
  if (a.sparse.isSparse) fill_sparse(accessor, a, numbers);
  return numbers;
}

void GltfModel::fill_sparse(int index, const tinygltf::Accessor& a, std::vector<float>& numbers) const {
  const auto& sparse = a.sparse;
  const std::size_t components = components_of(a.type);
  const std::size_t bytes = component_bytes(a.componentType);
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    fail(fmt::format("sparse accessor {} has a negative count or offset", index), "0 or more");
  }
  const auto count = static_cast<std::size_t>(sparse.count);
  const View places = view(index, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                           std::max<std::size_t>(1, component_bytes(sparse.indices.componentType)));
  const View values =
      view(index, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count, bytes * components);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t place = integer(sparse.indices.componentType, places.data + i * places.stride);
    if (place >= a.count) {
      fail(fmt::format("sparse accessor {} refers to element {}", index, place), fmt::format("an index below {}", a.count));
    }
    for (std::size_t k = 0; k < components; ++k) {
      numbers[place * components + k] = number(a, values.data + i * values.stride + k * bytes);
    }
  }
}

std::vector<Vec3> GltfModel::vectors(int accessor) const {
  const std::vector<float> all = numbers(accessor, TINYGLTF_TYPE_VEC3);
  std::vector<Vec3> vectors(all.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = {all[3 * i], all[3 * i + 1], all[3 * i + 2]};
  return vectors;
}

std::vector<std::uint32_t> GltfModel::integers(int accessor, int type) const {
  const tinygltf::Accessor& a = accessor_of(accessor, type);
  if (a.sparse.isSparse) fail(fmt::format("accessor {} of indices is sparse", accessor), "a dense accessor");
  const std::size_t components = components_of(type);
  const std::size_t bytes = component_bytes(a.componentType);
  const View v = view(accessor, a.bufferView, a.byteOffset, a.count, bytes * components);
  std::vector<std::uint32_t> integers;
  integers.reserve(a.count * components);
  for (std::size_t i = 0; i < a.count; ++i) {
    for (std::size_t k = 0; k < components; ++k) integers.push_back(integer(a.componentType, v.data + i * v.stride + k * bytes));
  }
  return integers;
}

}  // namespace raystudy
