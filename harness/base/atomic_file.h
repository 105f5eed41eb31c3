#pragma once

#include <filesystem>
#include <string_view>

namespace raystudy {

/// Writes a whole file so that a reader, a crash or a full disk meets either the old content or the new, never a part: a
/// temporary file beside it, fsync, rename, fsync of the folder. Makes missing folders. Throws Error naming the file and the
/// system's reason; the temporary file is gone then.
void write_file_atomically(const std::filesystem::path& file, std::string_view content);

/// Throws Error, naming the folder and the system's reason, where no file can be made in it. Makes missing folders.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace raystudy
