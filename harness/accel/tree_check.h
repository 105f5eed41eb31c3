#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "harness/geometry/box.h"
#include "harness/scene/scene.h"

namespace raystudy {

/// What the validations of all trees share: the list of findings, and what must hold of leaves, whatever the nodes above them.
class TreeCheck {
 public:
  /// Of a tree over `triangles` triangles. Where there is no scene, nothing is asked of their geometry.
  TreeCheck(std::size_t triangles, const Scene* scene, bool duplicates, std::size_t most)
      : scene_(scene), duplicates_(duplicates), most_(most), uses_(triangles), last_leaf_(triangles, no_leaf) {}

  template <class... Args>
  void report(fmt::format_string<Args...> format, Args&&... args) {
    if (!is_full()) problems_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
  [[nodiscard]] bool is_full() const { return problems_.size() >= most_; }

  /// Of a tree without nodes.
  void require_empty_scene() {
    if (!uses_.empty()) report("the tree is empty but the scene has {} triangles", uses_.size());
  }

  /// A leaf: that its triangles are in range and in it once, and that `box` holds each, or with duplicates meets it. `name` gives
  /// what messages call the leaf.
  template <class Name>
  void add_leaf(const Name& name, const Box& box, std::span<const std::uint32_t> triangles) {
    const std::uint32_t leaf = leaves_++;
    for (const std::uint32_t t : triangles) {
      if (t >= uses_.size()) {
        report("{} refers to triangle {} of {}", name(), t, uses_.size());
        continue;
      }
      if (last_leaf_[t] == leaf) report("{} refers to triangle {} twice", name(), t);
      last_leaf_[t] = leaf;
      ++uses_[t];
      if (scene_ == nullptr) continue;
      const Box own = scene_->triangle_box(t);
      if (!duplicates_ && !box.contains(own)) report("{} does not contain triangle {}", name(), t);
      if (duplicates_ && !box.overlaps(own)) report("{} does not meet triangle {}", name(), t);
      if (duplicates_) parts_.push_back({t, box});
    }
  }

  /// After the last leaf: that every triangle is in one, or with duplicates covered by those that it is in.
  void finish_leaves();

  [[nodiscard]] std::vector<std::string> take_problems() { return std::move(problems_); }

 private:
  static constexpr std::uint32_t no_leaf = std::numeric_limits<std::uint32_t>::max();

  /// A triangle in a leaf of that box.
  struct Part {
    std::uint32_t triangle;
    Box box;
  };

  void check_coverage();

  const Scene* scene_;
  bool duplicates_;
  std::size_t most_;
  std::uint32_t leaves_ = 0;
  std::vector<std::uint32_t> uses_;       ///< of each triangle
  std::vector<std::uint32_t> last_leaf_;  ///< of each triangle
  std::vector<Part> parts_;               ///< with duplicates
  std::vector<std::string> problems_;
};

}  // namespace raystudy
