#include "harness/scene/load.h"

#include <fmt/format.h>

#include <utility>

#include "harness/scene/frame_files.h"
#include "harness/scene/parsed_cache.h"
#include "harness/scene/sha256.h"
#include "harness/scene/source.h"

namespace raystudy {
namespace {

namespace fs = std::filesystem;

// Small files parse faster than a cache file opens.
constexpr std::size_t least_cached_bytes = std::size_t{1} << 16U;

/// A file on disk as load_scene sees it.
struct Input {
  const FileToRead* file;
  fs::path disk;
  Bytes bytes;
};

Input input_of(const FileToRead& file) {
  fs::path disk = file_on_disk(file.path);
  Bytes bytes = map_file(disk);
  return {&file, std::move(disk), std::move(bytes)};
}

void check_hash(const Input& input, const std::string& found) {
  if (input.file->sha256.empty() || found == input.file->sha256) return;
  fail_at(input.disk.string(), fmt::format("the SHA-256 is {}: the file is damaged or another version", found),
          fmt::format("{}, as {} says", input.file->sha256, input.file->described.text()));
}

/// Parses without any cache; `siblings` gets the files the model refers to.
Scene parse(const FileToRead& model, const std::vector<FileToRead>& frames, std::vector<Sibling>& siblings) {
  SourceFile source = open_source(model.path);
  if (!source.in_archive) {  // an archive's own hash covers what is in it
    source.sibling = [inner = source.sibling, &siblings](std::string_view relative) {
      auto bytes = inner(relative);
      siblings.push_back({std::string(relative), bytes ? xxh3_hex(as_text(*bytes)) : ""});
      return bytes;
    };
  }
  Scene scene = reader_for(source)(source);
  scene.name = source.stem;
  if (scene.vertices.empty() || scene.triangles.empty()) fail_at(source.name, "the scene has no triangles", "at least one");
  if (!scene.frames.empty() && !frames.empty()) {
    fail_at(source.name,
            fmt::format("the model moves of itself, in {} key frames, and has {} files of frames", scene.frames.size(),
                        frames.size()),
            "one of both");
  }
  for (const FileToRead& frame : frames) add_frames(scene, source.name, frame.path);
  finish_scene(scene, source.name);
  return scene;
}

}  // namespace

Scene load_scene(const FileToRead& model, const std::vector<FileToRead>& frames) {
  std::vector<Input> inputs{input_of(model)};
  for (const FileToRead& frame : frames) inputs.push_back(input_of(frame));
  std::string content = fmt::format("reader {}\n", reader_version);
  std::size_t bytes = 0;
  for (const Input& input : inputs) {
    const std::string inner = input.file->path.string().substr(input.disk.string().size());
    content += fmt::format("{} {}{}\n", xxh3_hex(as_text(input.bytes)), input.disk.filename().string(), inner);
    bytes += input.bytes.size();
  }
  const std::string key = xxh3_hex(content);
  const bool worth_caching = bytes >= least_cached_bytes;
  if (worth_caching) {
    if (auto cached = find_parsed(key, inputs.front().disk)) {
      for (std::size_t i = 0; i < inputs.size(); ++i) check_hash(inputs[i], cached->sha256[i]);
      return std::move(cached->scene);
    }
  }
  std::vector<std::string> hashes;
  for (const Input& input : inputs) {
    hashes.push_back(worth_caching || !input.file->sha256.empty() ? sha256_hex(as_text(input.bytes)) : "");
    check_hash(input, hashes.back());
  }
  std::vector<Sibling> siblings;
  Scene scene = parse(model, frames, siblings);
  if (worth_caching) keep_parsed(key, {scene, std::move(hashes), std::move(siblings)});
  return scene;
}

}  // namespace raystudy
