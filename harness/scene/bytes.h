#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "harness/base/error.h"
#include "harness/base/shared_array.h"

namespace raystudy {

/// The content of a file: mapped from disk, or unpacked into memory.
using Bytes = SharedArray<char>;

[[nodiscard]] inline std::string_view as_text(const Bytes& bytes) { return {bytes.data(), bytes.size()}; }
[[nodiscard]] Bytes to_bytes(std::string text);

/// Maps a regular file. Throws Error with the path and the system's reason.
[[nodiscard]] Bytes map_file(const std::filesystem::path& file);

/// 32 hex digits of XXH3-128.
[[nodiscard]] std::string xxh3_hex(std::string_view data);

/// Throws an Error with one diagnostic.
[[noreturn]] inline void fail_at(std::string_view file, std::string message, std::string expected = {}, int line = 0) {
  throw Error(Diagnostic{{std::string(file), line, 0}, std::move(message), std::move(expected), {}});
}

}  // namespace raystudy
