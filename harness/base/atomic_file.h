#pragma once

#include <filesystem>
#include <span>
#include <string_view>

namespace raystudy {

/// Whether what is written must outlive a power cut. That takes a wait for the disk, milliseconds each time.
enum class Durable : bool { no, yes };

/// Writes a whole file so that a reader, a crash or a full disk meets either the old content or the new, never a part: a
/// temporary file beside it, fsync where durable, rename. Makes missing folders. Throws Error naming the file and the system's
/// reason; the temporary file is gone then.
void write_file_atomically(const std::filesystem::path& file, std::string_view content, Durable durable = Durable::yes);
/// The same for content in parts, one after the other.
void write_file_atomically(const std::filesystem::path& file, std::span<const std::string_view> parts,
                           Durable durable = Durable::yes);

/// Removes what write_file_atomically left in the folder, and in folders below, where its process was killed in mid-write: files
/// named as its temporary ones are, whose process is gone and which nobody has written for a minute (a process of another
/// machine may share the folder).
void remove_stale_temporaries(const std::filesystem::path& folder);

/// Throws Error, naming the folder and the system's reason, where no file can be made in it. Makes missing folders.
void require_writable_folder(const std::filesystem::path& folder);

}  // namespace raystudy
