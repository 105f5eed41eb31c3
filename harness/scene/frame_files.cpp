#include "harness/scene/frame_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "harness/scene/source.h"

namespace raystudy {
namespace {

void check_finite(std::span<const Vec3> positions, std::size_t number, std::string_view file) {
  const auto bad = std::find_if(positions.begin(), positions.end(), [](Vec3 v) { return !is_finite(v); });
  if (bad == positions.end()) return;
  fail_at(file, fmt::format("vertex {} of frame {} is ({}, {}, {})", bad - positions.begin(), number, bad->x, bad->y, bad->z),
          "finite coordinates");
}

void add_sequence(Scene& scene, const SourceFile& source) {
  const std::size_t vertices = scene.vertices.size();
  const std::size_t frame_bytes = vertices * sizeof(Vec3);
  const std::size_t count = source.bytes.size() / frame_bytes;
  if (source.bytes.empty() || source.bytes.size() % frame_bytes != 0) {
    fail_at(source.name,
            source.bytes.empty() ? "the sequence has no frame"
                                 : fmt::format("the sequence has {} bytes and ends within frame {}", source.bytes.size(),
                                               scene.frames.size() + count),
            fmt::format("a multiple of {} bytes: {} vertices of three floats a frame", frame_bytes, vertices));
  }
  for (std::size_t f = 0; f < count; ++f) {
    std::vector<Vec3> positions(vertices);
    std::memcpy(positions.data(), source.bytes.data() + f * frame_bytes, frame_bytes);
    check_finite(positions, scene.frames.size(), source.name);
    scene.frames.emplace_back(std::move(positions));
  }
}

std::string corners(const Triangle& t) { return fmt::format("{}, {} and {}", t[0], t[1], t[2]); }

void check_topology(const Scene& frame, const Scene& scene, std::string_view file, std::string_view model) {
  const std::size_t number = scene.frames.size();
  if (frame.vertices.size() != scene.vertices.size() || frame.triangles.size() != scene.triangles.size()) {
    fail_at(file, fmt::format("frame {} has {} vertices and {} triangles", number, frame.vertices.size(), frame.triangles.size()),
            fmt::format("{} and {}, as {} has", scene.vertices.size(), scene.triangles.size(), model));
  }
  const auto [found, wanted] = std::mismatch(frame.triangles.begin(), frame.triangles.end(), scene.triangles.begin());
  if (found == frame.triangles.end()) return;
  fail_at(file,
          fmt::format("triangle {} of frame {} joins the vertices {}", found - frame.triangles.begin(), number, corners(*found)),
          fmt::format("{}, as in {}", corners(*wanted), model));
}

}  // namespace

void add_frames(Scene& scene, std::string_view model, const std::filesystem::path& file) {
  const SourceFile source = open_source(file);
  if (source.extension == "f32") return add_sequence(scene, source);
  const Scene frame = reader_for(source)(source);
  if (!frame.frames.empty()) {
    fail_at(source.name, fmt::format("frame {} moves of itself, in {} key frames", scene.frames.size(), frame.frames.size()),
            "a model that stands still");
  }
  check_topology(frame, scene, source.name, model);
  check_finite(frame.vertices, scene.frames.size(), source.name);
  scene.frames.push_back(frame.vertices);
}

}  // namespace raystudy
