#include "harness/scene/archive.h"

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

namespace raystudy {
namespace {

using Handle = std::unique_ptr<archive, decltype(&archive_read_free)>;

std::string reason(archive* a) {
  const char* text = archive_error_string(a);
  return text != nullptr ? text : "unexpected end of data";
}

// Only filters that work inside the process: libarchive's "all" would start programs named by the data.
Handle new_reader() {
  Handle a(archive_read_new(), archive_read_free);
  archive_read_support_filter_gzip(a.get());
  archive_read_support_filter_bzip2(a.get());
  archive_read_support_filter_xz(a.get());
  archive_read_support_filter_lzma(a.get());
  archive_read_support_filter_zstd(a.get());
  return a;
}

Handle open_archive(const Bytes& bytes, std::string_view name) {
  Handle a = new_reader();
  archive_read_support_format_zip(a.get());
  archive_read_support_format_tar(a.get());
  archive_read_support_format_ar(a.get());
  archive_read_support_format_7zip(a.get());
  if (archive_read_open_memory(a.get(), bytes.data(), bytes.size()) != ARCHIVE_OK) {
    fail_at(name, fmt::format("is no readable archive: {}", reason(a.get())));
  }
  return a;
}

/// The next regular file's name; nothing at the end.
std::optional<std::string> next_file(archive* a, std::string_view name) {
  archive_entry* entry = nullptr;
  for (;;) {
    const int status = archive_read_next_header(a, &entry);
    if (status == ARCHIVE_EOF) return std::nullopt;
    if (status < ARCHIVE_WARN) fail_at(name, fmt::format("the archive is damaged or cut short: {}", reason(a)));
    if (archive_entry_filetype(entry) != AE_IFREG) continue;
    const char* path = archive_entry_pathname(entry);
    if (path == nullptr) continue;
    std::string_view file = path;
    if (file.starts_with("./")) file.remove_prefix(2);
    return std::string(file);
  }
}

std::string read_data(archive* a, std::string_view name) {
  std::string data;
  std::array<char, 1 << 16> buffer{};
  for (;;) {
    const la_ssize_t got = archive_read_data(a, buffer.data(), buffer.size());
    if (got == 0) return data;
    if (got < 0) fail_at(name, fmt::format("the packed data is damaged or cut short: {}", reason(a)));
    data.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

template <std::size_t N>
bool any_of(const std::array<std::string_view, N>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

bool is_compression(std::string_view extension) {
  static constexpr std::array<std::string_view, 5> names{"gz", "xz", "zst", "bz2", "lzma"};
  return any_of(names, extension);
}

bool is_archive(std::string_view extension) {
  static constexpr std::array<std::string_view, 10> names{"zip", "pk3", "pk4", "tar", "tgz", "txz", "tbz2", "tzst", "deb", "7z"};
  return any_of(names, extension);
}

Bytes unpack_stream(const Bytes& packed, std::string_view name) {
  const Handle a = new_reader();
  archive_read_support_format_raw(a.get());
  archive_entry* entry = nullptr;
  if (packed.empty() || archive_read_open_memory(a.get(), packed.data(), packed.size()) != ARCHIVE_OK ||
      archive_read_next_header(a.get(), &entry) < ARCHIVE_WARN) {
    fail_at(name,
            fmt::format("the packed data is damaged or cut short: {}", packed.empty() ? "the file is empty" : reason(a.get())));
  }
  // The raw format takes anything; without a filter the data was never compressed.
  if (archive_filter_count(a.get()) < 2) fail_at(name, "is not compressed data", "gzip, xz, zstd, bzip2 or lzma");
  return to_bytes(read_data(a.get(), name));
}

std::vector<std::string> list_archived(const Bytes& archive, std::string_view name) {
  const Handle a = open_archive(archive, name);
  std::vector<std::string> entries;
  while (auto file = next_file(a.get(), name)) entries.push_back(*std::move(file));
  return entries;
}

std::optional<Bytes> read_archived(const Bytes& archive, std::string_view name, std::string_view entry) {
  const Handle a = open_archive(archive, name);
  while (const auto file = next_file(a.get(), name)) {
    if (*file == entry) return to_bytes(read_data(a.get(), fmt::format("{}/{}", name, entry)));
  }
  return std::nullopt;
}

Bytes read_inside(const Bytes& archive, std::string_view name, std::string_view inner) {
  const std::vector<std::string> entries = list_archived(archive, name);
  for (const std::string& entry : entries) {
    const bool leads_inside = inner.size() > entry.size() && inner.starts_with(entry) && inner[entry.size()] == '/';
    if (inner != entry && !leads_inside) continue;
    const Bytes bytes = *read_archived(archive, name, entry);
    return leads_inside ? read_inside(bytes, fmt::format("{}/{}", name, entry), inner.substr(entry.size() + 1)) : bytes;
  }
  throw Error(
      Diagnostic{{std::string(name), 0, 0}, fmt::format("the archive holds no '{}'", inner), {}, nearest_name(inner, entries)});
}

}  // namespace raystudy
