#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include "harness/accel/tree_file.h"
#include "harness/accel/tree_layout.h"
#include "harness/accel/validate.h"
#include "harness/base/error.h"

namespace raystudy {
namespace tree_layout {
namespace {

class Reader {
 public:
  /// The content must outlive it.
  Reader(std::string_view name, std::string_view content) : file_(name), all_(content) {
    check_front();
    check_header();
    read_table();
  }

  TreeFile read() {
    TreeFile read;
    read.tree = header_.kind == Kind::bvh2 ? read_bvh2() : read_wide();
    read.scene = section(scene_name);
    read.scene_hash = std::string(header_.scene_hash.data(), ::strnlen(header_.scene_hash.data(), header_.scene_hash.size()));
    read.scene_triangles = header_.scene_triangles;
    read.notes = {header_.traversal, header_.intersection, std::string(section(heuristic_name)),
                  std::string(section(provenance_name))};
    read.bytes = all_.size();
    return read;
  }

  /// Throws the findings, if there are any.
  void require_none(const std::vector<std::string>& problems) const {
    if (problems.empty()) return;
    std::vector<Diagnostic> all;
    all.reserve(problems.size());
    for (const std::string& problem : problems) all.push_back({{file_}, "wrong tree: " + problem, {}, {}});
    throw Error(std::move(all));
  }

  [[noreturn]] void fail(std::string message, std::string expected = {}) const {
    fail_at(file_, std::move(message), std::move(expected));
  }

 private:
  /// What tells a file that is whole from any other.
  void check_front() {
    const Header ours;
    const std::string_view magic(ours.magic.data(), ours.magic.size());
    if (!all_.starts_with(magic)) fail("is no tree file", fmt::format("one that begins with '{}'", magic));
    if (all_.size() < sizeof header_) fail(fmt::format("has {} bytes", all_.size()), "a header of 128: the file was cut off");
    std::memcpy(static_cast<void*>(&header_), all_.data(), sizeof header_);
    if (header_.version != tree_file_version) {
      fail(fmt::format("is of version {} of the format", header_.version),
           fmt::format("version {}, the only one that is read", tree_file_version));
    }
    if (header_.file_bytes != all_.size()) {
      fail(fmt::format("has {} bytes", all_.size()), fmt::format("{}, as its header says", header_.file_bytes));
    }
    if (const std::uint64_t found = checksum({&all_, 1}); found != header_.checksum) {
      fail(fmt::format("is damaged: its checksum is {:016x}", found), fmt::format("{:016x}", header_.checksum));
    }
  }

  void check_header() const {
    const std::uint32_t w = header_.width;
    if (header_.kind != Kind::bvh2 && header_.kind != Kind::wide_bvh) {
      fail(fmt::format("is of kind {}", static_cast<std::uint32_t>(header_.kind)), "1 (bvh2) or 2 (wide-bvh)");
    }
    if (header_.kind == Kind::bvh2 && w != 2) fail(fmt::format("has {} children a node", w), "2 of a bvh2");
    if (header_.kind == Kind::wide_bvh && w != 4 && w != 8 && w != 16) {
      fail(fmt::format("has {} children a node", w), "4, 8 or 16 of a wide-bvh");
    }
    if (header_.boxes != Boxes::float_planes && (header_.boxes != Boxes::byte_planes || w == 2)) {
      fail(fmt::format("has boxes of form {}", static_cast<std::uint32_t>(header_.boxes)),
           w == 2 ? "0 (float)" : "0 (float) or 1 (8-bit)");
    }
    if (header_.duplicates > 1) fail(fmt::format("says {} of duplicates", header_.duplicates), "0 or 1");
    if (!(header_.traversal >= 0 && header_.intersection >= 0) || !std::isfinite(header_.traversal + header_.intersection)) {
      fail(fmt::format("has the costs c_T = {} and c_I = {}", header_.traversal, header_.intersection), "finite ones >= 0");
    }
  }

  void read_table() {
    const std::uint64_t end = sizeof(Header) + std::uint64_t{header_.sections} * sizeof(Section);
    if (end > all_.size()) fail(fmt::format("has {} sections", header_.sections), "a table within the file");
    std::uint64_t at = end;
    for (std::uint32_t i = 0; i < header_.sections; ++i) {
      Section entry;
      std::memcpy(&entry, all_.data() + sizeof(Header) + i * sizeof(Section), sizeof entry);
      const std::string name(entry.name.data(), ::strnlen(entry.name.data(), entry.name.size()));
      if (entry.offset % 64 != 0 || entry.offset < at || entry.offset > all_.size() || entry.bytes > all_.size() - entry.offset) {
        fail(fmt::format("section '{}' is at {} with {} bytes", name, entry.offset, entry.bytes),
             fmt::format("a multiple of 64 from {} on, within the file", at));
      }
      at = entry.offset + entry.bytes;
      if (!sections_.emplace(name, all_.substr(entry.offset, entry.bytes)).second) {
        fail(fmt::format("has two sections '{}'", name), "one");
      }
    }
  }

  [[nodiscard]] std::string_view section(std::string_view name) const {
    const auto found = sections_.find(name);
    if (found == sections_.end()) fail(fmt::format("has no section '{}'", name));
    return found->second;
  }

  /// A section of elements of so many bytes: how many they are.
  [[nodiscard]] std::size_t count(std::string_view name, std::size_t bytes) const {
    const std::size_t size = section(name).size();
    if (size % bytes != 0 || size / bytes > std::numeric_limits<std::uint32_t>::max()) {
      fail(fmt::format("section '{}' has {} bytes", name, size), fmt::format("a multiple of {}, at most 2^32 times", bytes));
    }
    return size / bytes;
  }

  template <class Array>
  void read_elements(std::string_view name, Array& array) const {
    array.resize(count(name, sizeof array[0]));
    const std::string_view from = section(name);
    if (!from.empty()) std::memcpy(array.data(), from.data(), from.size());
  }

  /// A triangle that no leaf holds would be found later; here it keeps a header from asking for more memory than the file has.
  template <class Allocator>
  void read_triangles(std::vector<std::uint32_t, Allocator>& triangles) const {
    read_elements(triangles_name, triangles);
    if (triangles.size() < header_.scene_triangles) {
      fail(fmt::format("refers to {} triangles", triangles.size()),
           fmt::format("at least the scene's {}", header_.scene_triangles));
    }
  }

  template <class Nodes>
  void read_nodes(Nodes& nodes) const {
    nodes.resize(count(nodes_name, record_bytes<typename Nodes::value_type>()));
    const char* at = section(nodes_name).data();
    for (auto& node : nodes) {
      for_each_field(node, [&at](auto& field) {
        std::memcpy(static_cast<void*>(&field), at, sizeof field);
        at += sizeof field;
      });
    }
  }

  template <class Nodes>
  void read_orders(Nodes& nodes) const {
    const std::string_view orders = section(orders_name);
    const std::size_t bytes = sizeof(Nodes::value_type::order);
    if (orders.size() != nodes.size() * bytes) {
      fail(fmt::format("section '{}' has {} bytes", orders_name, orders.size()),
           fmt::format("{} for each of {} nodes", bytes, nodes.size()));
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) std::memcpy(&nodes[i].order, orders.data() + i * bytes, bytes);
  }

  [[nodiscard]] std::unique_ptr<Accel> read_bvh2() const {
    auto bvh = std::make_unique<Bvh2>();
    bvh->duplicates = header_.duplicates != 0;
    read_triangles(bvh->triangles);
    read_nodes(bvh->nodes);
    return bvh;
  }

  [[nodiscard]] std::unique_ptr<Accel> read_wide() const {
    auto bvh = std::make_unique<WideBvh>();
    bvh->duplicates = header_.duplicates != 0;
    bvh->bounds = header_.bounds;
    bvh->height = header_.height;
    read_triangles(bvh->triangles);
    read_elements(corners_name, bvh->corners);
    if (header_.boxes == Boxes::float_planes) {
      read_wide_nodes<WideNode<4>, WideNode<8>, WideNode<16>>(bvh->nodes);
    } else {
      read_wide_nodes<QuantizedNode<4>, QuantizedNode<8>, QuantizedNode<16>>(bvh->nodes);
    }
    return bvh;
  }

  template <class... Node>
  void read_wide_nodes(WideBvh::Nodes& nodes) const {
    const auto read = [&]<class Own>(Own*) {
      if (header_.width != Own::width) return;
      auto& array = nodes.emplace<WideBvh::NodeArray<Own>>();
      read_nodes(array);
      read_orders(array);
    };
    (read(static_cast<Node*>(nullptr)), ...);
  }

  std::string file_;
  std::string_view all_;
  Header header_;
  std::map<std::string, std::string_view, std::less<>> sections_;
};

}  // namespace
}  // namespace tree_layout

namespace {

std::string scene_text(std::string_view name, std::uint64_t triangles, std::string_view hash) {
  return fmt::format("scene '{}' of {} triangles (hash {})", name, triangles, hash.empty() ? "none" : hash);
}

}  // namespace

TreeFile read_tree(const std::filesystem::path& file) { return read_tree(file.string(), map_file(file)); }

TreeFile load_tree(const std::filesystem::path& file, const Scene& scene) {
  return load_tree(file.string(), map_file(file), scene);
}

TreeFile read_tree(std::string_view name, const Bytes& content) {
  tree_layout::Reader reader(name, as_text(content));
  TreeFile read = reader.read();
  reader.require_none(find_structural_problems(*read.tree, read.scene_triangles));
  return read;
}

TreeFile load_tree(std::string_view name, const Bytes& content, const Scene& scene) {
  tree_layout::Reader reader(name, as_text(content));
  TreeFile read = reader.read();
  if (read.scene_hash != scene.hash || read.scene_triangles != scene.triangles.size()) {
    reader.fail(fmt::format("is of {}", scene_text(read.scene, read.scene_triangles, read.scene_hash)),
                scene_text(scene.name, scene.triangles.size(), scene.hash));
  }
  reader.require_none(find_problems(*read.tree, scene));
  return read;
}

}  // namespace raystudy
