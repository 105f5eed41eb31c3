#include "harness/scene/parsed_cache.h"

#include <fmt/format.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>

#include "harness/scene/catalog.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The file: this header, then the sections vertices, triangles, material indices, frames and description, each from a multiple of
// 64 bytes on, so that the arrays can be used where they are mapped. Little-endian; other machines see a wrong magic.
struct FileHeader {
  std::array<char, 8> magic{'R', 'A', 'Y', 'S', 'C', 'E', 'N', 'E'};
  std::uint64_t version = 1;
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
  std::uint64_t material_indices = 0;
  std::uint64_t frames = 0;
  std::uint64_t description_bytes = 0;
  std::uint64_t content_hash = 0;  ///< XXH3-64 of all bytes after the header
  std::uint64_t header_hash = 0;   ///< XXH3-64 of the fields above
  std::array<std::uint64_t, 7> reserved{};
};
static_assert(sizeof(FileHeader) == 128);

std::uint64_t hash_of(const FileHeader& header) { return XXH3_64bits(&header, offsetof(FileHeader, header_hash)); }

constexpr std::size_t rounded(std::size_t bytes) { return (bytes + 63) / 64 * 64; }

struct Layout {
  explicit Layout(const FileHeader& h)
      : triangles(sizeof(FileHeader) + rounded(h.vertices * sizeof(Vec3))),
        material_indices(triangles + rounded(h.triangles * sizeof(Triangle))),
        frames(material_indices + rounded(h.material_indices * sizeof(std::uint32_t))),
        description(frames + h.frames * rounded(h.vertices * sizeof(Vec3))),
        end(description + rounded(h.description_bytes)) {}
  std::size_t vertices = sizeof(FileHeader);
  std::size_t triangles;
  std::size_t material_indices;
  std::size_t frames;
  std::size_t description;
  std::size_t end;
};

json to_json(Vec3 v) { return {v.x, v.y, v.z}; }
Vec3 to_vec3(const json& j) { return {j.at(0).get<float>(), j.at(1).get<float>(), j.at(2).get<float>()}; }

json describe(const ParsedScene& parsed) {
  const Scene& s = parsed.scene;
  json d{{"name", s.name},
         {"hash", s.hash},
         {"lower", to_json(s.bounds.lower)},
         {"upper", to_json(s.bounds.upper)},
         {"sha256", parsed.sha256}};
  for (const char* list : {"siblings", "materials", "lights", "cameras"}) d[list] = json::array();
  for (const Sibling& x : parsed.siblings) d["siblings"].push_back({x.relative, x.hash});
  for (const Material& m : s.materials) {
    d["materials"].push_back({m.name, static_cast<int>(m.kind), to_json(m.color), to_json(m.emission), m.refraction_index});
  }
  for (const Light& l : s.lights) d["lights"].push_back({l.name, to_json(l.position), to_json(l.intensity), l.point_at_infinity});
  for (const Camera& c : s.cameras) {
    d["cameras"].push_back({c.name, to_json(c.eye), to_json(c.target), to_json(c.up), c.vertical_fov});
  }
  return d;
}

void restore(const json& d, ParsedScene& parsed) {
  Scene& s = parsed.scene;
  d.at("name").get_to(s.name);
  d.at("hash").get_to(s.hash);
  s.bounds = {to_vec3(d.at("lower")), to_vec3(d.at("upper"))};
  d.at("sha256").get_to(parsed.sha256);
  for (const json& x : d.at("siblings")) parsed.siblings.push_back({x.at(0), x.at(1)});
  for (const json& m : d.at("materials")) {
    s.materials.push_back({m.at(0), static_cast<MaterialKind>(m.at(1).get<int>()), to_vec3(m.at(2)), to_vec3(m.at(3)), m.at(4)});
  }
  for (const json& l : d.at("lights")) s.lights.push_back({l.at(0), to_vec3(l.at(1)), to_vec3(l.at(2)), l.at(3)});
  for (const json& c : d.at("cameras")) {
    s.cameras.push_back({c.at(0), to_vec3(c.at(1)), to_vec3(c.at(2)), to_vec3(c.at(3)), c.at(4)});
  }
}

template <class T>
SharedArray<T> section(const Bytes& file, std::size_t offset, std::size_t count) {
  const auto* first = reinterpret_cast<const T*>(file.data() + offset);  // NOLINT: mapped, and aligned by the layout
  return {std::make_shared<Bytes>(file), {first, count}};
}

/// Why a mapped file is no intact cache file; empty for an intact one.
std::string damage(const Bytes& file, FileHeader& header) {
  if (file.size() < sizeof header) return "it is shorter than its header";
  std::memcpy(&header, file.data(), sizeof header);
  if (header.magic != FileHeader{}.magic || header.version != FileHeader{}.version) return "it does not begin as one";
  if (header.header_hash != hash_of(header)) return "its header is damaged";
  if (file.size() != Layout(header).end) return fmt::format("it has {} bytes instead of {}", file.size(), Layout(header).end);
  const std::string_view content = as_text(file).substr(sizeof header);
  return header.content_hash == XXH3_64bits(content.data(), content.size()) ? "" : "its content is damaged";
}

std::optional<fs::path> cache_folder() {
  const auto cache = user_cache();
  return cache ? std::optional(*cache / "parsed") : std::nullopt;
}

ParsedScene parsed_from(const Bytes& file, const FileHeader& header) {
  const Layout at(header);
  ParsedScene parsed;
  parsed.scene.vertices = section<Vec3>(file, at.vertices, header.vertices);
  parsed.scene.triangles = section<Triangle>(file, at.triangles, header.triangles);
  parsed.scene.triangle_materials = section<std::uint32_t>(file, at.material_indices, header.material_indices);
  for (std::size_t f = 0; f < header.frames; ++f) {
    parsed.scene.frames.push_back(section<Vec3>(file, at.frames + f * rounded(header.vertices * sizeof(Vec3)), header.vertices));
  }
  const std::string_view text = as_text(file).substr(at.description, header.description_bytes);
  restore(json::from_cbor(text), parsed);
  return parsed;
}

bool siblings_unchanged(const ParsedScene& parsed, const fs::path& model) {
  for (const Sibling& sibling : parsed.siblings) {
    const auto bytes = file_beside(model, sibling.relative);
    if ((bytes ? xxh3_hex(as_text(*bytes)) : "") != sibling.hash) return false;
  }
  return true;
}

/// A temporary file beside its target: renamed there by `commit`, removed otherwise.
class AtomicFile {
 public:
  explicit AtomicFile(const fs::path& target)
      : target_(target.string()), name_(target_ + ".XXXXXX"), fd_(::mkstemp(name_.data())) {
    if (fd_ < 0) error_ = errno;
  }
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile() {
    if (fd_ < 0) return;
    ::close(fd_);
    if (!committed_) ::unlink(name_.c_str());
  }
  void write(const void* data, std::size_t bytes) {
    const char* p = static_cast<const char*>(data);
    while (bytes > 0 && error_ == 0) {
      const ssize_t done = ::write(fd_, p, bytes);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) error_ = done < 0 ? errno : ENOSPC;
      if (done <= 0) return;
      p += done;
      bytes -= static_cast<std::size_t>(done);
    }
  }
  void seek(std::size_t offset) {
    if (error_ == 0 && ::lseek(fd_, static_cast<off_t>(offset), SEEK_SET) < 0) error_ = errno;
  }
  void commit() {
    if (error_ == 0 && ::rename(name_.c_str(), target_.c_str()) != 0) error_ = errno;
    committed_ = error_ == 0;
  }
  [[nodiscard]] int error() const { return error_; }

 private:
  std::string target_;
  std::string name_;
  int fd_;
  int error_ = 0;
  bool committed_ = false;
};

class Writer {
 public:
  explicit Writer(AtomicFile& file) : file_(file) { XXH3_64bits_reset(state_.get()); }
  void section(const void* data, std::size_t bytes) {
    static constexpr std::array<char, 64> zeros{};
    put(data, bytes);
    put(zeros.data(), rounded(bytes) - bytes);
  }
  [[nodiscard]] std::uint64_t hash() const { return XXH3_64bits_digest(state_.get()); }

 private:
  void put(const void* data, std::size_t bytes) {
    if (bytes == 0) return;
    XXH3_64bits_update(state_.get(), data, bytes);
    file_.write(data, bytes);
  }
  AtomicFile& file_;
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_{XXH3_createState(), XXH3_freeState};
};

void write_file(AtomicFile& file, const ParsedScene& parsed) {
  const Scene& s = parsed.scene;
  const std::vector<std::uint8_t> description = json::to_cbor(describe(parsed));
  FileHeader header;
  header.vertices = s.vertices.size();
  header.triangles = s.triangles.size();
  header.material_indices = s.triangle_materials.size();
  header.frames = s.frames.size();
  header.description_bytes = description.size();
  file.write(&header, sizeof header);
  Writer writer(file);
  writer.section(s.vertices.data(), s.vertices.size() * sizeof(Vec3));
  writer.section(s.triangles.data(), s.triangles.size() * sizeof(Triangle));
  writer.section(s.triangle_materials.data(), s.triangle_materials.size() * sizeof(std::uint32_t));
  for (const auto& frame : s.frames) writer.section(frame.data(), frame.size() * sizeof(Vec3));
  writer.section(description.data(), description.size());
  header.content_hash = writer.hash();
  header.header_hash = hash_of(header);
  file.seek(0);
  file.write(&header, sizeof header);
  file.commit();
}

void warn_once(const std::string& text) {
  static std::atomic<bool> warned = false;
  if (!warned.exchange(true)) fmt::print(stderr, "warning: {}\n", text);
}

}  // namespace

std::optional<ParsedScene> find_parsed(std::string_view key, const fs::path& model) {
  const auto folder = cache_folder();
  if (!folder) return std::nullopt;
  const fs::path path = *folder / fmt::format("{}.scene", key);
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return std::nullopt;
  std::string what;
  try {
    const Bytes file = map_file(path);
    FileHeader header;
    what = damage(file, header);
    if (what.empty()) {
      ParsedScene parsed = parsed_from(file, header);
      if (siblings_unchanged(parsed, model)) return parsed;
      return std::nullopt;
    }
  } catch (const std::exception& error) {
    what = error.what();
  }
  fmt::print(stderr, "warning: {}: the cached scene is not usable ({}); parsing {} again\n", path.string(), what, model.string());
  fs::remove(path, ignored);
  return std::nullopt;
}

void keep_parsed(std::string_view key, const ParsedScene& parsed) {
  const auto folder = cache_folder();
  if (!folder) return warn_once("parsed scenes are not cached: neither XDG_CACHE_HOME nor HOME is set");
  std::error_code failed;
  fs::create_directories(*folder, failed);
  int error = failed.value();
  if (error == 0) {
    AtomicFile file(*folder / fmt::format("{}.scene", key));
    if (file.error() == 0) write_file(file, parsed);
    error = file.error();
  }
  if (error != 0) {
    warn_once(fmt::format("parsed scenes are not cached: {} cannot be written: {}", folder->string(), std::strerror(error)));
  }
}

}  // namespace raystudy
