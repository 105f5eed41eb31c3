#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "harness/scene/bytes.h"

namespace raystudy {

/// Whether a lower-case extension names a compressed stream (gz, xz, zst, bz2, lzma).
[[nodiscard]] bool is_compression(std::string_view extension);
/// Whether a lower-case extension names an archive (zip, pk3, tar, tgz, txz, deb, 7z…).
[[nodiscard]] bool is_archive(std::string_view extension);

/// Unpacks one compressed stream. Throws Error with `name` where the data is damaged, cut short or not compressed at all.
[[nodiscard]] Bytes unpack_stream(const Bytes& packed, std::string_view name);

/// The names of an archive's regular files, without a leading "./", in the archive's order. Throws Error.
[[nodiscard]] std::vector<std::string> list_archived(const Bytes& archive, std::string_view name);
/// The content of one file of an archive; nothing where there is none of that name. Throws Error.
[[nodiscard]] std::optional<Bytes> read_archived(const Bytes& archive, std::string_view name, std::string_view entry);
/// A file inside an archive, through archives in it (`data.tar.xz/usr/share/pak1.pk3/maps/a.bsp`); compressed streams on the way
/// are unpacked, the file itself comes as it is. Throws Error, with the nearest name where there is no such file.
[[nodiscard]] Bytes read_inside(const Bytes& archive, std::string_view name, std::string_view inner);

}  // namespace raystudy
