// All formats without a reader of their own, by way of Assimp: Ogre, AC3D, FBX, Collada, 3DS, Blender...
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <numbers>

#include "harness/scene/gather.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

/// Gives Assimp the unpacked bytes, so that it can read inside archives too.
class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(Bytes bytes) : bytes_(std::move(bytes)) {}
  std::size_t Read(void* to, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - position_) / size);
    if (whole > 0) std::memcpy(to, bytes_.data() + position_, whole * size);
    position_ += whole * size;
    return whole;
  }
  std::size_t Write(const void* /*from*/, std::size_t /*size*/, std::size_t /*count*/) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? position_ : bytes_.size();
    const std::size_t to = base + offset;  // wraps round for offsets that are negative
    if (to > bytes_.size()) return aiReturn_FAILURE;
    position_ = to;
    return aiReturn_SUCCESS;
  }
  [[nodiscard]] std::size_t Tell() const override { return position_; }
  [[nodiscard]] std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  Bytes bytes_;
  std::size_t position_ = 0;
};

class SourceFiles final : public Assimp::IOSystem {
 public:
  explicit SourceFiles(const SourceFile& source) : source_(source), main_(source.stem + '.' + source.extension) {}
  [[nodiscard]] const std::string& main_file() const { return main_; }
  [[nodiscard]] bool Exists(const char* file) const override { return bytes(file).has_value(); }
  [[nodiscard]] char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::strpbrk(mode, "wa+") != nullptr) return nullptr;
    auto found = bytes(file);
    return found ? new MemoryStream(*std::move(found)) : nullptr;  // NOLINT: Assimp frees it through Close
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }  // NOLINT

 private:
  [[nodiscard]] std::optional<Bytes> bytes(std::string file) const {
    while (file.starts_with("./")) file.erase(0, 2);
    if (file == main_) return source_.bytes;
    return source_.sibling(file);
  }

  const SourceFile& source_;
  std::string main_;
};

Vec3 vec3(const aiColor3D& c) { return {c.r, c.g, c.b}; }

Material converted(const aiMaterial& m) {
  Material material;
  aiString name;
  if (m.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
  aiColor3D color;
  if (m.Get(AI_MATKEY_COLOR_DIFFUSE, color) == aiReturn_SUCCESS) material.color = vec3(color);
  if (m.Get(AI_MATKEY_COLOR_EMISSIVE, color) == aiReturn_SUCCESS && !color.IsBlack()) {
    material.kind = MaterialKind::emitter;
    material.emission = vec3(color);
    return material;
  }
  float value = 0;
  if (m.Get(AI_MATKEY_OPACITY, value) == aiReturn_SUCCESS && value < 1) {
    material.kind = MaterialKind::refractive;
    material.color = Vec3{1};
    if (m.Get(AI_MATKEY_REFRACTI, value) == aiReturn_SUCCESS && value >= 1) material.refraction_index = value;
  } else if (m.Get(AI_MATKEY_REFLECTIVITY, value) == aiReturn_SUCCESS && value > 0.5F) {
    material.kind = MaterialKind::reflective;
    if (m.Get(AI_MATKEY_COLOR_SPECULAR, color) == aiReturn_SUCCESS) material.color = vec3(color);
  }
  return material;
}

/// Assimp knows Ogre's meshes as version 1.8 only. A mesh of version 1.100 is given to it under that number: on the one such file
/// at hand (the catalog's sibenik-ogre-mesh) count, bounds and looks are right; what Assimp cannot read it still refuses.
SourceFile with_known_version(SourceFile source) {
  constexpr std::string_view newer("\x00\x10[MeshSerializer_v1.100]\n", 26);
  constexpr std::string_view known("\x00\x10[MeshSerializer_v1.8]\n", 24);
  if (as_text(source.bytes).starts_with(newer)) {
    source.bytes = to_bytes(std::string(known) + std::string(as_text(source.bytes).substr(newer.size())));
  }
  return source;
}

class AssimpReader {
 public:
  explicit AssimpReader(SourceFile source) : source_(std::move(source)), gather_{source_.name} {}

  Scene read() {
    Assimp::Importer importer;
    auto* files = new SourceFiles(source_);  // NOLINT: the importer takes it over
    importer.SetIOHandler(files);
    const aiScene* scene = importer.ReadFile(files->main_file(), aiProcess_Triangulate);
    if (scene == nullptr) fail_at(source_.name, fmt::format("Assimp cannot read the file: {}", importer.GetErrorString()));
    for (unsigned m = 0; m < scene->mNumMaterials; ++m) gather_.scene.materials.push_back(converted(*scene->mMaterials[m]));
    if (scene->mRootNode != nullptr) add_node(*scene, *scene->mRootNode, {});
    for (unsigned c = 0; c < scene->mNumCameras; ++c) add_camera(*scene, *scene->mCameras[c]);
    return gather_.finished();
  }

 private:
  void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent) {
    const aiMatrix4x4 transform = parent * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      if (node.mMeshes[m] < scene.mNumMeshes) add_mesh(*scene.mMeshes[node.mMeshes[m]], transform);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add_node(scene, *node.mChildren[c], transform);
  }

  void add_mesh(const aiMesh& mesh, const aiMatrix4x4& transform) {
    std::vector<Vec3> positions(mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D p = transform.IsIdentity() ? mesh.mVertices[v] : transform * mesh.mVertices[v];
      positions[v] = {p.x, p.y, p.z};
    }
    std::vector<Triangle> triangles;
    triangles.reserve(mesh.mNumFaces);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices == 3) triangles.push_back({{face.mIndices[0], face.mIndices[1], face.mIndices[2]}});
    }
    // Where Assimp gives each corner a vertex of its own, the file's connectivity is in the equal positions.
    if (mesh.mNumVertices == 3 * mesh.mNumFaces) weld_equal(positions, triangles);
    gather_.add(positions, triangles, mesh.mMaterialIndex);
  }

  void add_camera(const aiScene& scene, const aiCamera& c) {
    aiMatrix4x4 transform;
    for (const aiNode* node = scene.mRootNode->FindNode(c.mName); node != nullptr; node = node->mParent) {
      transform = node->mTransformation * transform;
    }
    const auto vec = [](const aiVector3D& v) { return Vec3{v.x, v.y, v.z}; };
    const float aspect = c.mAspect > 0 ? c.mAspect : 1;
    const float vertical = 2 * std::atan(std::tan(c.mHorizontalFOV / 2) / aspect);
    gather_.scene.cameras.push_back({.name = c.mName.C_Str(),
                                     .eye = vec(transform * c.mPosition),
                                     .target = vec(transform * (c.mPosition + c.mLookAt)),
                                     .up = vec(aiMatrix3x3(transform) * c.mUp),
                                     .vertical_fov = vertical * 180 / std::numbers::pi_v<float>});
  }

  SourceFile source_;
  Gather gather_;
};

}  // namespace

const std::vector<std::string>& assimp_extensions() {
  static const std::vector<std::string> all = [] {
    aiString list;
    Assimp::Importer().GetExtensionList(list);
    std::vector<std::string> names;
    std::string_view rest = list.C_Str();
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(';'), rest.size());
      if (rest.starts_with("*.")) names.emplace_back(rest.substr(2, end - 2));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return names;
  }();
  return all;
}

Scene read_assimp(const SourceFile& source) { return AssimpReader(with_known_version(source)).read(); }

}  // namespace raystudy
