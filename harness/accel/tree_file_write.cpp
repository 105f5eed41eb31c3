#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <type_traits>
#include <vector>

#include "harness/accel/tree_file.h"
#include "harness/accel/tree_layout.h"
#include "harness/accel/validate.h"
#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace raystudy {
namespace tree_layout {
namespace {

template <class T>
std::string_view bytes_of(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <class Array>
std::string_view elements_of(const Array& array) {
  return {reinterpret_cast<const char*>(array.data()), array.size() * sizeof(array[0])};
}

template <class Nodes>
std::string records_of(const Nodes& nodes) {
  std::string records;
  records.reserve(nodes.size() * record_bytes<typename Nodes::value_type>());
  for (const auto& node : nodes) for_each_field(node, [&](const auto& field) { records += bytes_of(field); });
  return records;
}

/// The file in parts. What they refer to must outlive them.
class Image {
 public:
  void add(std::string_view name, std::string_view content) {
    Section& section = table_.emplace_back();
    std::copy(name.begin(), name.end(), section.name.begin());
    section.bytes = content.size();
    contents_.push_back(content);
  }

  /// Header and table filled in; valid until the image changes.
  std::vector<std::string_view> finish(Header& header) {
    const std::uint64_t front = sizeof(Header) + table_.size() * sizeof(Section);
    std::uint64_t at = front;
    std::vector<std::string_view> parts{bytes_of(header), elements_of(table_)};
    for (std::size_t i = 0; i < table_.size(); ++i) {
      parts.emplace_back(zeros_.data(), aligned(at) - at);
      table_[i].offset = aligned(at);
      parts.push_back(contents_[i]);
      at = table_[i].offset + table_[i].bytes;
    }
    header.version = tree_file_version;
    header.sections = static_cast<std::uint32_t>(table_.size());
    header.file_bytes = at;
    header.checksum = checksum(parts);
    return parts;
  }

 private:
  static constexpr std::array<char, 64> zeros_{};
  std::vector<Section> table_;
  std::vector<std::string_view> contents_;
};

Header header_of(const Scene& scene, const TreeNotes& notes) {
  Header header;
  header.scene_triangles = scene.triangles.size();
  if (scene.hash.size() == header.scene_hash.size()) std::copy(scene.hash.begin(), scene.hash.end(), header.scene_hash.begin());
  header.traversal = notes.traversal;
  header.intersection = notes.intersection;
  return header;
}

void describe(Header& header, const Bvh2& bvh) {
  header.kind = Kind::bvh2;
  header.width = 2;
  header.duplicates = bvh.duplicates ? 1 : 0;
}

void describe(Header& header, const WideBvh& bvh) {
  header.kind = Kind::wide_bvh;
  header.width = static_cast<std::uint32_t>(bvh.width());
  header.boxes = bvh.quantized() ? Boxes::byte_planes : Boxes::float_planes;
  header.duplicates = bvh.duplicates ? 1 : 0;
  header.bounds = bvh.bounds;
  header.height = bvh.height;
}

std::string node_records(const Bvh2& bvh) {
  std::string records = records_of(bvh.nodes);
  // The second slot is padding, whatever it holds.
  if (!bvh.empty()) std::memset(records.data() + sizeof(Bvh2Node), 0, sizeof(Bvh2Node));
  return records;
}

std::string node_records(const WideBvh& bvh) {
  return bvh.visit([](const auto& nodes) { return records_of(nodes); });
}

std::string orders_of(const WideBvh& bvh) {
  std::string orders;
  bvh.visit([&orders](const auto& nodes) {
    for (const auto& node : nodes) orders += bytes_of(node.order);
  });
  return orders;
}

template <class Tree>
void write(const std::filesystem::path& file, const Tree& tree, const Scene& scene, const TreeNotes& notes) {
  if (const auto problems = find_problems(tree, scene, 1); !problems.empty()) {
    throw Error(Diagnostic{{file.string()}, fmt::format("a wrong tree is not saved: {}", problems.front()), {}, {}});
  }
  Header header = header_of(scene, notes);
  describe(header, tree);
  const std::string records = node_records(tree);
  std::string orders;
  Image image;
  image.add(nodes_name, records);
  image.add(triangles_name, elements_of(tree.triangles));
  if constexpr (std::is_same_v<Tree, WideBvh>) {
    orders = orders_of(tree);
    image.add(orders_name, orders);
    image.add(corners_name, elements_of(tree.corners));
  }
  image.add(scene_name, scene.name);
  image.add(heuristic_name, notes.heuristic);
  image.add(provenance_name, notes.provenance);
  write_file_atomically(file, image.finish(header));
}

}  // namespace
}  // namespace tree_layout

bool is_saveable(std::string_view kind) { return kind == Bvh2::kind_name || kind == WideBvh::kind_name; }

void save_tree(const std::filesystem::path& file, const Accel& tree, const Scene& scene, const TreeNotes& notes) {
  if (const auto* bvh = dynamic_cast<const Bvh2*>(&tree)) return tree_layout::write(file, *bvh, scene, notes);
  if (const auto* wide = dynamic_cast<const WideBvh*>(&tree)) return tree_layout::write(file, *wide, scene, notes);
  throw Error(Diagnostic{{file.string()},
                         fmt::format("a tree of kind '{}' cannot be saved", tree.kind()),
                         fmt::format("'{}' or '{}'", Bvh2::kind_name, WideBvh::kind_name),
                         {}});
}

}  // namespace raystudy
