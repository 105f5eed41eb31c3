#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "harness/accel/bvh2.h"
#include "harness/accel/wide_bvh.h"

// What stands where in a tree file, as tree_file.md describes it.
namespace raystudy::tree_layout {

static_assert(std::endian::native == std::endian::little, "tree files are little-endian and written as they lie in memory");

enum class Kind : std::uint32_t { bvh2 = 1, wide_bvh = 2 };
enum class Boxes : std::uint32_t { float_planes = 0, byte_planes = 1 };

struct Header {
  std::array<char, 8> magic{'R', 'A', 'Y', 'S', 'T', 'R', 'E', 'E'};
  std::uint32_t version = 0;
  std::uint32_t sections = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t checksum = 0;  ///< XXH3-64 of all bytes of the file but these eight
  Kind kind = Kind::bvh2;
  std::uint32_t width = 2;  ///< children of a node
  Boxes boxes = Boxes::float_planes;
  std::uint32_t duplicates = 0;  ///< 1 where a triangle may be in several leaves
  std::uint64_t scene_triangles = 0;
  std::array<char, 32> scene_hash{};  ///< zeros where there is none
  float traversal = 0;
  float intersection = 0;
  Box bounds;                ///< of a wide tree
  std::uint32_t height = 0;  ///< of a wide tree
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Header) == 128 && offsetof(Header, checksum) == 24 && offsetof(Header, bounds) == 96);

/// An entry of the table behind the header.
struct Section {
  std::array<char, 16> name{};  ///< filled up with zeros
  std::uint64_t offset = 0;     ///< from the beginning of the file, a multiple of 64
  std::uint64_t bytes = 0;
};
static_assert(sizeof(Section) == 32);

constexpr std::string_view nodes_name = "nodes";
constexpr std::string_view orders_name = "orders";
constexpr std::string_view triangles_name = "triangles";
constexpr std::string_view corners_name = "corners";
constexpr std::string_view scene_name = "scene";
constexpr std::string_view heuristic_name = "heuristic";
constexpr std::string_view provenance_name = "provenance";

/// Of a file in parts, the first of which is the header.
[[nodiscard]] std::uint64_t checksum(std::span<const std::string_view> parts);

constexpr std::uint64_t aligned(std::uint64_t offset) { return (offset + 63) / 64 * 64; }

/// Calls f with each field of a node's record in the file, which has no gaps, in their order. The bindings name every field, so
/// that a node with one more does not compile: it belongs into the file, with a new version of the format, or the reader must
/// make it from the others. `order` has a section of its own.
template <class F>
constexpr void for_each_field(auto& node, const F& f) {
  if constexpr (requires { node.is_leaf(); }) {
    auto& [box, first, count] = node;
    f(box), f(first), f(count);
  } else if constexpr (requires { node.origin; }) {
    auto& [origin, exponent, bounds, child, order] = node;
    f(origin), f(exponent), f(bounds), f(child);
  } else {
    auto& [bounds, child, order] = node;
    f(bounds), f(child);
  }
}

template <class Node>
[[nodiscard]] consteval std::size_t record_bytes() {
  const Node node{};
  std::size_t bytes = 0;
  for_each_field(node, [&bytes](const auto& field) { bytes += sizeof field; });
  return bytes;
}

}  // namespace raystudy::tree_layout
