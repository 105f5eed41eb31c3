// STL, binary and ASCII. The format has no connectivity: corners that are equal bit for bit become one vertex, in the order of
// their first use, and nothing else is merged.
#include <fmt/format.h>

#include <cstring>

#include "harness/scene/gather.h"
#include "harness/scene/source.h"
#include "harness/scene/text_cursor.h"

namespace raystudy {
namespace {

constexpr std::size_t header_bytes = 84;
constexpr std::size_t facet_bytes = 50;

Scene welded(const SourceFile& source, std::vector<Vec3> corners) {
  if (corners.empty()) fail_at(source.name, "the scene has no triangles", "at least one");
  std::vector<Triangle> triangles(corners.size() / 3);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) triangles[t] = {{3 * t, 3 * t + 1, 3 * t + 2}};
  weld_equal(corners, triangles);
  Gather gather{source.name};
  gather.add(corners, triangles, 0);
  return gather.finished();
}

Scene read_binary(const SourceFile& source, std::size_t count) {
  std::vector<Vec3> corners(3 * count);
  const char* facet = source.bytes.data() + header_bytes;
  for (std::size_t t = 0; t < count; ++t, facet += facet_bytes) {
    std::memcpy(&corners[3 * t], facet + sizeof(Vec3), 3 * sizeof(Vec3));  // after the normal
  }
  return welded(source, std::move(corners));
}

Scene read_ascii(const SourceFile& source) {
  TextCursor cursor(source);
  std::vector<Vec3> corners;
  const auto expect = [&cursor](std::string_view wanted) {
    const std::string_view word = cursor.next_word();
    if (word == wanted) return;
    cursor.fail(word.empty() ? "the file ends in a facet" : fmt::format("found '{}'", shown(word)), fmt::format("'{}'", wanted));
  };
  for (std::string_view word = cursor.next_word(); !word.empty(); word = cursor.next_word()) {
    if (word == "solid" || word == "endsolid") {
      (void)cursor.rest_of_line();
      continue;
    }
    if (word != "facet") cursor.fail(fmt::format("found '{}'", shown(word)), "'facet', 'solid' or 'endsolid'");
    (void)cursor.rest_of_line();  // the normal
    expect("outer");
    expect("loop");
    for (int k = 0; k < 3; ++k) {
      expect("vertex");
      Vec3 v;
      for (int axis = 0; axis < 3; ++axis) {
        const std::string_view number = cursor.next_word();
        if (!TextCursor::parse(number, v[axis])) {
          cursor.fail(fmt::format("'{}' stands where a coordinate should", shown(number)), "a number");
        }
      }
      corners.push_back(v);
    }
    expect("endloop");
    expect("endfacet");
  }
  return welded(source, std::move(corners));
}

}  // namespace

Scene read_stl(const SourceFile& source) {
  const std::size_t size = source.bytes.size();
  std::uint32_t count = 0;
  if (size >= header_bytes) std::memcpy(&count, source.bytes.data() + header_bytes - sizeof count, sizeof count);
  // Binary files may begin with "solid" too; the size tells. Some writers append bytes, so an ASCII file is what has no facet
  // count that fits and begins as one.
  const bool fits = size >= header_bytes && size >= header_bytes + facet_bytes * count;
  const bool begins_ascii = as_text(source.bytes).starts_with("solid");
  if (fits && (!begins_ascii || size == header_bytes + facet_bytes * count)) return read_binary(source, count);
  if (begins_ascii) return read_ascii(source);
  if (size < header_bytes) {
    fail_at(source.name, fmt::format("the file has {} bytes", size), "an STL file: 'solid' or a binary header of 84 bytes");
  }
  fail_at(source.name, fmt::format("the file ends at facet {} of {}", (size - header_bytes) / facet_bytes, count),
          "a complete file");
}

}  // namespace raystudy
